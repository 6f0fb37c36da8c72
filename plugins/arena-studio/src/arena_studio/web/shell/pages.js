// Which page is shown: `#/NAME?KEY=VALUE` in the address, so that a reload, a bookmark and the browser's buttons find
// it again.

/**
 * @typedef {object} Context what a page is given
 * @property {typeof import("studio/shell/api.js").api} api
 * @property {typeof import("studio/shell/say.js").say} say
 * @property {typeof import("studio/shell/dialog.js").ask} ask
 * @property {(page: string, query?: Record<string, string>, replace?: boolean) => void} navigate
 * @property {URLSearchParams} query
 *
 * @typedef {object} Page
 * @property {string} name
 * @property {string} title
 * @property {(root: HTMLElement, context: Context) => (() => void) | Promise<() => void>} mount show it; returns what
 * ends it
 */

export const PAGES = [
  { name: "run", title: "Run" },
  { name: "results", title: "Results" },
  { name: "curves", title: "Curves" },
  { name: "map", title: "Maps" },
  { name: "scenario", title: "Scenarios" },
  { name: "task", title: "Tasks" },
];

export class Pages {
  /** @param {HTMLElement} root @param {HTMLElement} menu @param {Omit<Context, "navigate" | "query">} tools */
  constructor(root, menu, tools) {
    this.root = root;
    this.menu = menu;
    this.tools = tools;
    this.turn = 0;
    this.shown = "";
    /** @type {() => void} */ this.unmount = () => {};
  }

  start() {
    this.menu.replaceChildren(
      ...PAGES.map(({ name, title }) =>
        Object.assign(document.createElement("a"), { href: `#/${name}`, textContent: title }),
      ),
    );
    addEventListener("hashchange", () => this.show());
    this.show();
  }

  /**
   * @param {string} name
   * @param {Record<string, string>} [query]
   * @param {boolean} [replace] the address alone: the page goes on as it is
   */
  navigate(name, query = {}, replace = false) {
    const words = new URLSearchParams(Object.entries(query).filter(([, value]) => value !== "")).toString();
    const hash = `#/${name}${words ? `?${words}` : ""}`;
    this.shown = hash;
    if (replace) return history.replaceState(null, "", hash);
    this.shown = "";
    if (location.hash === hash) this.show();
    else location.hash = hash;
  }

  async show() {
    if (location.hash && location.hash === this.shown) return;
    const [, name = "", words = ""] = /^#\/(\w+)(?:\?(.*))?$/.exec(location.hash) ?? [];
    const found = PAGES.find((page) => page.name === name);
    if (!found) return location.replace(`#/${PAGES[0].name}`);
    this.shown = location.hash;
    const turn = ++this.turn;
    this.unmount();
    this.unmount = () => {};
    this.mark(found);
    try {
      const { page } = await import(`studio/pages/${found.name}.js`);
      if (turn !== this.turn) return;
      await this.mount(page, new URLSearchParams(words), turn);
    } catch (error) {
      if (turn === this.turn)
        this.tools.say(`${found.title} cannot be shown: ${error instanceof Error ? error.message : error}`, "error");
    }
  }

  /** @param {Page} page @param {URLSearchParams} query @param {number} turn */
  async mount(page, query, turn) {
    const root = document.createElement("div");
    root.className = `page ${page.name}`;
    this.root.replaceChildren(root);
    const unmount = await page.mount(root, { ...this.tools, query, navigate: this.navigate.bind(this) });
    if (turn === this.turn) this.unmount = unmount;
    else unmount(); // another page was opened meanwhile
  }

  /** @param {{name: string, title: string}} page */
  mark({ name, title }) {
    document.title = `${title} - arena studio`;
    for (const link of this.menu.children) {
      if (link.getAttribute("href") === `#/${name}`) link.setAttribute("aria-current", "page");
      else link.removeAttribute("aria-current");
    }
  }
}
