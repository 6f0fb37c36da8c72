/** @type {import("studio/shell/pages.js").Page} */
export const page = {
  name: "run",
  title: "Run",
  mount(root) {
    root.append(Object.assign(document.createElement("h1"), { textContent: "Run" }));
    return () => {};
  },
};
