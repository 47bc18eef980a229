// The examples of docs/guide/javascript.md.

import { readFile } from "node:fs/promises";

const page = await readFile(new URL("../../../../docs/guide/javascript.md", import.meta.url), "utf8");
/** Blocks of JavaScript, in the page's order. */
export const [forNode, forThree] = [...page.matchAll(/```js\n(.*?)```/gs)].map((match) => match[1]);
