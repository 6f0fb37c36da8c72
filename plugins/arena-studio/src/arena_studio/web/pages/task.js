// The page of the task editor: curricula, rules of random problems, scenario packs.

import { guardPage } from "studio/edit/autosave.js";
import { isWriting, undoKeys } from "studio/edit/tools.js";
import { button, make } from "studio/shell/forms.js";
import { CurriculumPart } from "studio/task/curriculum.js";
import { PacksPart } from "studio/task/packs.js";
import { RulesPart } from "studio/task/rules.js";

const TITLES = /** @type {const} */ ({ curriculum: "Curricula", rules: "Random problems", packs: "Scenario packs" });

/** @type {import("../shell/pages.js").Page} */
export const page = { name: "task", title: "Tasks", mount };

/** @param {HTMLElement} root @param {import("../shell/pages.js").Context} context */
async function mount(root, context) {
  const style = make("link", { rel: "stylesheet", href: "/web/task/task.css" });
  const styled = new Promise((done) => style.addEventListener("load", done, { once: true }));
  document.head.append(style);
  await styled;
  const kinds = await context.api.get("/api/scenarios/kinds");
  const curriculum = new CurriculumPart(context);
  const parts = { curriculum, rules: new RulesPart(context, kinds), packs: new PacksPart(context) };
  const tabs = make("div", { className: "parts", role: "tablist", "aria-label": "what is edited" });
  const place = make("div", { role: "tabpanel" });
  const loaded = new Set();

  /** @param {keyof typeof parts} name */
  const show = async (name) => {
    for (const tab of tabs.querySelectorAll("button")) {
      const is = tab.dataset.part === name;
      tab.setAttribute("aria-selected", String(is));
      tab.tabIndex = is ? 0 : -1;
    }
    place.setAttribute("aria-label", TITLES[name]);
    place.replaceChildren(parts[name].element);
    if (!loaded.has(name)) await parts[name].trying(() => parts[name].load());
    loaded.add(name);
  };
  const names = /** @type {(keyof typeof parts)[]} */ (Object.keys(TITLES));
  tabs.append(...names.map((name) => button(TITLES[name], () => turn(name), { role: "tab", "data-part": name })));
  const turn = (/** @type {keyof typeof parts} */ name) => {
    context.navigate("task", { part: name, path: name === "curriculum" ? curriculum.path : "" }, true);
    void show(name);
  };
  tabs.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const at = names.findIndex((name) => tabs.querySelector(`[data-part="${name}"][aria-selected="true"]`));
    if (!step || at < 0) return;
    const next = names[(at + step + names.length) % names.length];
    turn(next);
    /** @type {HTMLElement} */ (tabs.querySelector(`[data-part="${next}"]`)).focus();
  });
  root.append(make("h1", { className: "hidden" }, page.title), tabs, place);
  await show(names.find((name) => name === context.query.get("part")) ?? "curriculum");
  const path = context.query.get("path");
  if (path) await curriculum.trying(() => curriculum.open(path));

  /** @param {KeyboardEvent} event */
  const pressed = (event) => void (!isWriting(event.target) && undoKeys(event, curriculum.history));
  addEventListener("keydown", pressed);
  const unguard = guardPage(() => curriculum.autosave);
  return () => {
    removeEventListener("keydown", pressed);
    unguard();
    style.remove();
    void curriculum.close();
  };
}
