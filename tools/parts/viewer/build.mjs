// Bundles the viewer into a single HTML file: node build.mjs SOURCES NODE_MODULES OUT.html
import { build } from "esbuild";
import { readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";

const [source, modules, out] = process.argv.slice(2);
const { outputFiles } = await build({
  entryPoints: [join(source, "main.js")],
  nodePaths: [modules],
  outdir: dirname(out),
  bundle: true,
  minify: true,
  legalComments: "inline", // keeps the licences of the bundled packages
  target: ["chrome109", "firefox115", "safari16.4"],
  write: false,
});
const text = (ending) => outputFiles.find((file) => file.path.endsWith(ending)).text;
const parts = {
  EVODEVO_STYLE: text(".css"),
  EVODEVO_PROGRAM: text(".js").replaceAll("</script", "<\\/script"),
};
const page = await readFile(join(source, "page.html"), "utf8");
// a function, since $ has a special meaning in replacement strings
await writeFile(
  out,
  page.replace(/EVODEVO_(STYLE|PROGRAM)/g, (name) => parts[name]),
);
