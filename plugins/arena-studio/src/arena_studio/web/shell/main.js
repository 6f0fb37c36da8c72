// Starts the studio: forgets the token in the address, and hands over to the pages.

import { api } from "studio/shell/api.js";
import { ask } from "studio/shell/dialog.js";
import { Pages } from "studio/shell/pages.js";
import { holdChanges } from "studio/shell/press.js";
import { say } from "studio/shell/say.js";

const bare = new URL(location.href);
bare.searchParams.delete("token"); // the server has made a cookie of it, which no script can read
history.replaceState(null, "", bare);

const pages = new Pages(
  /** @type {HTMLElement} */ (document.getElementById("page")),
  /** @type {HTMLElement} */ (document.getElementById("pages")),
  {
    api,
    say,
    ask,
  },
);
holdChanges(document);
pages.start();

api
  .get("/api/project")
  .then((/** @type {{name: string, folder: string}} */ project) => {
    const place = /** @type {HTMLElement} */ (document.getElementById("project"));
    place.textContent = project.name;
    place.title = project.folder;
  })
  .catch((error) => say(error.message, "error"));
