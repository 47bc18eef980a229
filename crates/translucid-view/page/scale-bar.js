// A length in the picture, and the mean free paths of the material that is selected beside it.

import { byId, make, setText } from "./dom.js";
import { format } from "./numbers.js";
import { MILLIMETERS, readable } from "./units.js";

/** Longest bar, in letters of the page and as a share of the picture. */
const LONGEST = 12;
const SHARE = 0.25;

export class ScaleBar {
    #session;
    #picture;
    #navigation;
    #materials;

    constructor(session, picture, navigation, materials) {
        this.#session = session;
        this.#picture = picture;
        this.#navigation = navigation;
        this.#materials = materials;
        byId("mfp-bars").append(...["r", "g", "b"].map((channel) => make("span", { className: channel })));
        session.on("state", () => this.show());
        picture.onResize(() => this.show());
        materials.onSelect(() => this.show());
    }

    show() {
        const { state, hello } = this.#session;
        if (!state || !hello) return;
        const { width } = this.#picture.rect;
        const millimeters = MILLIMETERS[hello.unit] ?? 1;
        const letter = parseFloat(getComputedStyle(document.documentElement).fontSize);
        // Of a pixel of CSS, at the depth of the point that was clicked last.
        const perPixel = (this.#navigation.lengthPerPixel * state.film.width * millimeters) / width;
        const length = nice(Math.min(LONGEST * letter, width * SHARE) * perPixel);
        if (!Number.isFinite(length) || length <= 0) return;
        byId("bar").style.width = `${length / perPixel}px`;
        const unit = readable(length, "mm");
        setText(byId("bar-text"), `${format(length / MILLIMETERS[unit])} ${unit}`);
        byId("scale").title = this.#navigation.picked?.position ? "At the depth of the point that was clicked last" : "At the depth of the camera\u2019s target";
        const mfp = this.#materials.material?.mfp ?? [];
        const scatters = this.#materials.material?.parameters.subsurface_weight;
        byId("mfp-bars").hidden = !(scatters?.value > 0 || scatters?.image);
        [...byId("mfp-bars").children].forEach((bar, i) => {
            bar.style.width = `${Math.min(width * 0.5, ((mfp[i] ?? 0) * millimeters) / perPixel)}px`;
        });
    }
}

/** The greatest of 1, 2, 5 times a power of ten up to a length. */
function nice(most) {
    const power = 10 ** Math.floor(Math.log10(most));
    return [5, 2, 1].find((n) => n * power <= most) * power;
}
