// The page of `translucid view`: makes its parts and connects them.

import { Compare } from "./compare.js";
import { Connection } from "./connection.js";
import { copyButton } from "./copy.js";
import { Dock } from "./dock.js";
import { byId, make, setText } from "./dom.js";
import { EnvironmentPanel } from "./environment.js";
import { History } from "./history.js";
import { openSocket, startSaving, startScenes } from "./host.js";
import { Inspector } from "./inspector.js";
import { startKeyboard } from "./keyboard.js";
import { LightsPanel } from "./lights.js";
import { MaterialPanel } from "./material.js";
import { startMenu } from "./menus.js";
import { Navigation } from "./navigation.js";
import { Notices } from "./notices.js";
import { NumbersPanel } from "./numbers-panel.js";
import { Picture } from "./picture.js";
import { startProbe } from "./probe.js";
import { RenderPanel } from "./render.js";
import { ScaleBar } from "./scale-bar.js";
import { Session } from "./session.js";
import { Status } from "./status.js";
import { startTabs } from "./tabs.js";
import { startTheme } from "./theme.js";
import { ViewBar } from "./view-bar.js";

const connection = new Connection(openSocket);
const session = new Session(connection);

const picture = new Picture(session);
startProbe(connection, session, picture);
// The first picture is on its way while the panels are made.
session.connect();

const notices = new Notices(session);
const navigation = new Navigation(session, picture);
const viewBar = new ViewBar(session, navigation);
const compare = new Compare(session, picture);
const status = new Status(session);
const history = new History(session);
const dock = new Dock();
new Inspector(session, picture, compare);
const materials = new MaterialPanel(session);
new LightsPanel(session);
new EnvironmentPanel(session, notices);
new RenderPanel(session, picture);
new ScaleBar(session, picture, navigation, materials);
new NumbersPanel(session, materials, dock);
startSaving(session, notices);
startScenes(connection, notices);
startTheme();
startMenu("save");
startMenu("notes");
const tabs = startTabs(byId("tabs"));
startKeyboard({ session, history, viewBar, compare, dock, picture, status });

navigation.onPick(({ material }) => {
    if (material === null || material === undefined) return;
    materials.select(material);
    tabs.show("tab-material");
});

session.on("hello", ({ name, version, objects }) => {
    const file = name.split(/[/\\]/).at(-1);
    setText(byId("scene-name"), file);
    document.title = `${file} \u2013 translucid`;
    const triangles = objects.reduce((sum, object) => sum + object.triangles, 0);
    byId("scene-name").title = `${name}: ${objects.length} objects, ${triangles} triangles; translucid ${version}`;
});
session.on("state", ({ command, notes }) => {
    setText(byId("command"), command);
    byId("notes").hidden = notes.length === 0;
    setText(byId("notes-count"), notes.length === 1 ? "1 note" : `${notes.length} notes`);
    const texts = [...byId("notes-list").children].map((item) => item.textContent);
    if (texts.join("\n") !== notes.join("\n")) byId("notes-list").replaceChildren(...notes.map((note) => make("li", {}, note)));
});
byId("command").after(copyButton({ id: "copy-command", label: "Copy the command", text: () => session.state?.command ?? "" }));

// The plots wait until the picture is there.
let isPlotted = false;
picture.onPainted(async () => {
    if (isPlotted) return;
    isPlotted = true;
    const { ProfilePanel } = await import("./profile-panel.js");
    new ProfilePanel(session, materials, dock);
});
