// Connections that are lost, pages that sleep, two pages at once.

import assert from "node:assert/strict";
import { createServer } from "node:net";
import { test } from "node:test";

import { difference, launch, serve, start, SCENE, View } from "./view.mjs";

const { open, server, browser, folder } = await start();

test("two pages show one session: what one changes the other shows", async () => {
    const [one, two] = [await open(), await open()];
    await one.type("material-specular_roughness", 0.77);
    await one.done();
    await two.done(await one.version());
    await two.page.waitForFunction(() => document.getElementById("material-specular_roughness").value === "0.77");
    assert.equal(difference((await one.pixels()).codes, (await two.pixels()).codes), 0);
    await two.history("undo");
    await one.done(await two.version());
    assert.notEqual((await one.state()).sides.a.materials[0].parameters.specular_roughness.value, 0.77);
    await one.page.close();
    await two.page.close();
});

test("a reload comes back to the same state and picture", async () => {
    const view = await open();
    await view.type("material-coat_weight", 0.6);
    await view.done();
    const [state, shown] = [await view.state(), await view.pixels()];
    await view.load();
    await view.done();
    assert.deepEqual((await view.state()).sides, state.sides);
    assert.equal(difference((await view.pixels()).codes, shown.codes), 0);
    await view.page.close();
});

/** Passes bytes between the browser and the server until it is cut. */
async function wire(port) {
    const { connect } = await import("node:net");
    const sockets = new Set();
    let isCut = false;
    const listener = createServer((from) => {
        if (isCut) return from.destroy();
        const to = connect(port, "127.0.0.1");
        for (const [a, b] of [[from, to], [to, from]]) {
            sockets.add(a);
            a.pipe(b);
            a.on("error", () => b.destroy());
            a.on("close", () => b.destroy());
        }
    });
    await new Promise((resolve) => listener.listen(0, "127.0.0.1", resolve));
    return {
        port: listener.address().port,
        cut() {
            isCut = true;
            for (const socket of sockets) socket.destroy();
            sockets.clear();
        },
        mend() {
            isCut = false;
        },
        close: () => listener.close(),
    };
}

test("a connection that was lost comes back to the same state, and says so meanwhile", async () => {
    const address = new URL(server.address);
    const between = await wire(Number(address.port));
    // The server answers to its own name only, so the browser is told another way to it.
    const mapped = await launch({ more: [`--host-resolver-rules=MAP 127.0.0.1:${address.port} 127.0.0.1:${between.port}`] });
    const view = new View(await mapped.newPage(), server, folder);
    try {
        await view.load();
        await view.type("material-coat_weight", 0.25);
        await view.done();
        const shown = await view.pixels();
        between.cut();
        await view.page.locator("#lost").waitFor({ state: "visible" });
        assert.match(await view.page.locator("#lost-text").textContent(), /connection was lost/);
        await view.page.waitForTimeout(1500);
        between.mend();
        await view.page.locator("#lost").waitFor({ state: "hidden" });
        await view.page.waitForFunction(() => window.translucidView.connected);
        await view.done();
        assert.ok(Math.abs((await view.state()).sides.a.materials[0].parameters.coat_weight.value - 0.25) < 1e-6);
        assert.equal(difference((await view.pixels()).codes, shown.codes), 0);
        await view.type("material-coat_weight", 0.5);
        await view.agrees("after coming back");
    } finally {
        await mapped.close();
        between.close();
    }
});

test("a command that has ended is named as the reason", async () => {
    const short = await serve(SCENE);
    const view = new View(await browser.newPage(), short, folder);
    await view.load();
    await short.stop();
    await view.page.waitForFunction(() => document.getElementById("lost-text").textContent.includes("Is the command still running?"));
    await view.page.locator("#lost-now").waitFor();
    await view.page.close();
});

test("a page that nobody sees gets no frames, and catches up when it is seen", async () => {
    const view = await open();
    await view.done();
    const session = await view.page.context().newCDPSession(view.page);
    await session.send("Page.setWebLifecycleState", { state: "frozen" });
    const other = await open();
    await other.type("material-specular_roughness", 0.61);
    await other.done();
    await session.send("Page.setWebLifecycleState", { state: "active" });
    await view.page.waitForFunction(() => Math.abs(window.translucidView.state.sides.a.materials[0].parameters.specular_roughness.value - 0.61) < 1e-6);
    await view.done(await other.version());
    assert.equal(difference((await view.pixels()).codes, (await other.pixels()).codes), 0);
    await view.page.close();
    await other.page.close();
});
