// Brings three.js out of the page, where it lies packed, when it is first asked for.

import { bytesOf, unpack } from "arena/decode.js";

const PART = 0x8000; // bytes that are turned into letters at a time

/** @type {Promise<any> | null} */ let loaded = null;

/** Return three.js; throw an Error with one line where the page has none. @returns {Promise<any>} */
export function loadThree() {
  loaded ??= load();
  return loaded;
}

async function load() {
  const packed = document.getElementById("three")?.textContent?.trim();
  if (!packed) throw new Error("this page was written without three.js");
  const bytes = new Uint8Array(await unpack(bytesOf(packed)));
  let letters = "";
  for (let at = 0; at < bytes.length; at += PART) letters += String.fromCharCode(...bytes.subarray(at, at + PART));
  return import(`data:text/javascript;base64,${btoa(letters)}`); // which the page's policy allows, as its own modules
}
