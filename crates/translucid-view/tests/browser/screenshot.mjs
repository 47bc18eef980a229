// Makes the picture of the page that README and guide show: `TRANSLUCID=… node screenshot.mjs ../../../../docs/images [SAMPLES]`.

import { join } from "node:path";

import { launch, serve } from "./view.mjs";

const [folder, samples = "72"] = process.argv.slice(2);
const server = await serve("--size", "960x540", "--spp", samples, "--subsurface", "normalized-diffusion-oblique");
const browser = await launch();
const page = await browser.newPage({ viewport: { width: 1440, height: 900 }, colorScheme: "dark" });
page.setDefaultTimeout(3_600_000);
await page.goto(server.address);
await page.waitForFunction(() => window.translucidView?.samples > 0);

// The bust's material, its profile, and the random walk on the right of the line
const canvas = await page.locator("#picture-a").boundingBox();
await page.mouse.click(canvas.x + 0.58 * canvas.width, canvas.y + 0.35 * canvas.height);
await page.click("#truth");
await page.click("#toggle-numbers");
await page.waitForFunction(() => window.translucidView.status.phase === "done");
await page.mouse.move(canvas.x + 0.2 * canvas.width, canvas.y + 0.55 * canvas.height);
await page.waitForTimeout(1000);
await page.screenshot({ path: join(folder, "view.jpg"), type: "jpeg", quality: 95 });
await browser.close();
await server.stop();
