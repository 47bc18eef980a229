// The mean free path: one length for all channels, and a share of it for each.

import { lengthPerPixel } from "./camera.js";
import { NumberRow, NumbersRow } from "./row.js";
import { logarithmic } from "./scale.js";
import { distance } from "./vector.js";

const CHANNELS = ["red", "green", "blue"];

/** Rows by the keys of what they show: `subsurface_radius`, `mfp` with a slider a channel, `subsurface_radius_scale`. */
export function meanFreePath(session, panel) {
    const { unit } = session.hello;
    // Four decades below half the width of what the camera sees at first.
    const { camera } = session.state;
    const width = lengthPerPixel(camera, 1, distance(camera.position, camera.target));
    const scale = logarithmic(width * 5e-5, width * 0.5);
    const limits = { least: 0 };
    const set = (values, how, key) => session.setMaterial(panel.index, values, { ...how, key });
    const factors = () => panel.material.parameters.subsurface_radius_scale.value;

    const radius = new NumberRow({
        id: "material-subsurface_radius",
        name: "Mean free path",
        unit,
        scale,
        limits,
        hint: "subsurface_radius: all channels at once",
        className: "main",
        change: session.editing((value, how) => set({ subsurface_radius: value }, how, "radius")),
    });

    const channels = CHANNELS.map((name, i) => new NumberRow({
        id: `material-mfp-${name}`,
        name: name.charAt(0).toUpperCase() + name.slice(1),
        unit,
        scale,
        limits,
        hint: "subsurface_radius \u00d7 subsurface_radius_scale",
        labels: { subsurface_radius: "Mean free path", subsurface_radius_scale: "Scale" },
        className: `channel ${name[0]}`,
        change: session.editing((value, how) => {
            const whole = panel.material.parameters.subsurface_radius.value;
            if (whole > 0) return set({ subsurface_radius_scale: factors().with(i, value / whole) }, how, "scale");
            // Nothing to be a share of: this channel becomes the whole.
            const only = [0, 0, 0].with(i, 1);
            set({ subsurface_radius: value, subsurface_radius_scale: only }, how, "scale");
        }),
    }));
    const mfp = {
        element: document.createDocumentFragment(),
        show(values) {
            channels.forEach((row, i) => row.show(values[i]));
        },
    };
    mfp.element.append(...channels.map((row) => row.element));

    const shares = new NumbersRow({
        id: "material-subsurface_radius_scale",
        name: "Scale",
        letters: ["R", "G", "B"],
        parts: ["r", "g", "b"],
        scale: { ...logarithmic(1e-3, 10), least: 0 },
        hint: "subsurface_radius_scale",
        change: session.editing((value, how) => set({ subsurface_radius_scale: value }, how, "scale")),
    });

    return [["subsurface_radius", radius], ["mfp", mfp], ["subsurface_radius_scale", shares]];
}
