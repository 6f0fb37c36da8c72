// Lets node's test runner resolve the names of the pages' import maps (arena/…, studio/…), as tsconfig.json's paths
// have them.
// usage: node --import ./scripts/names.js --test FILES
import { readFileSync } from "node:fs";
import { register } from "node:module";

const { paths } = JSON.parse(readFileSync(new URL("../tsconfig.json", import.meta.url), "utf8")).compilerOptions;
const folders = Object.entries(paths).map(([name, [folder]]) => [
  name.slice(0, -1),
  new URL(`../${folder.slice(0, -1)}`, import.meta.url).href,
]);
const source = `
const folders = ${JSON.stringify(folders)};
export async function resolve(name, context, next) {
  const found = folders.find(([prefix]) => name.startsWith(prefix));
  return next(found ? found[1] + name.slice(found[0].length) : name, context);
}`;
register(`data:text/javascript,${encodeURIComponent(source)}`);
