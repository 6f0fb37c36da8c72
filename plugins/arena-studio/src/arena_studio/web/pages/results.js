/** @type {import("studio/shell/pages.js").Page} */
export const page = {
  name: "results",
  title: "Results",
  mount(root) {
    root.append(Object.assign(document.createElement("h1"), { textContent: "Results" }));
    return () => {};
  },
};
