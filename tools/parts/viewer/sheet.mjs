// Pictures of robots side by side on one sheet.
import { join } from "node:path";
import { draw } from "./browser.mjs";

/** Makes the stage of a report as large as a tile, without captions. */
export const shrinkStage = (page, { width, height }) =>
  page.addStyleTag({
    content: `.stage { width: ${width}px !important; height: ${height}px !important; min-height: 0 !important;
        aspect-ratio: auto !important }
      .caption { display: none }`,
  });

/** Returns a tile: the robot on the stage at a time, above a text in HTML. */
export async function tile(page, time, text) {
  await draw(page, time);
  const png = (await (await page.$("canvas")).screenshot()).toString("base64");
  return `<figure><img src="data:image/png;base64,${png}"><figcaption>${text}</figcaption></figure>`;
}

/** Writes the picture of a sheet with `across` tiles in each row. */
export async function writeSheet(browser, tiles, across, width, folder, name) {
  const sheet = await browser.newPage({ viewport: { width: across * width, height: 100 } });
  await sheet.setContent(`<style>
    body { margin: 0; background: white; font: 13px system-ui, sans-serif; color: #444;
      display: grid; grid-template-columns: repeat(${across}, 1fr) }
    figure { margin: 0; padding: 4px } img { width: 100%; display: block; border-radius: 6px }
    figcaption { padding: 3px 2px } b { color: #b8404f }
  </style>${tiles.join("")}`);
  await sheet.screenshot({ path: join(folder, name), fullPage: true });
}
