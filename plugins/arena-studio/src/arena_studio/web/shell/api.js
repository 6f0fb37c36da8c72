// Asks the server. Every failure is an Error with the server's own line; its `status` is 0 where there was no answer.

/** @typedef {Error & {status: number}} ApiError */

/** @param {string} text @param {number} status @returns {ApiError} */
function failure(text, status) {
  return Object.assign(new Error(text), { status });
}

/** @param {Response} answer */
async function lineOf(answer) {
  const text = await answer.text();
  try {
    return JSON.parse(text).error || text;
  } catch {
    return text || `${answer.status} ${answer.statusText}`;
  }
}

/** @param {string} path @param {RequestInit} request @returns {Promise<Response>} */
async function asked(path, request) {
  let answer;
  try {
    answer = await fetch(path, request);
  } catch (error) {
    if (error instanceof DOMException && error.name === "AbortError") throw error;
    throw failure("the studio does not answer; is `arena studio` still running?", 0);
  }
  if (!answer.ok) throw failure(await lineOf(answer), answer.status);
  return answer;
}

/** @param {string} method @param {unknown} body @param {Record<string, string>} headers @returns {RequestInit} */
function sent(method, body, headers = {}) {
  const raw = body instanceof Uint8Array || body instanceof ArrayBuffer || body instanceof Blob;
  const type = raw ? "application/octet-stream" : "application/json";
  return {
    method,
    body: /** @type {BodyInit} */ (raw ? body : JSON.stringify(body ?? null)),
    headers: { "Content-Type": type, ...headers },
  };
}

export const api = {
  /** @param {string} path @param {AbortSignal} [signal] @returns {Promise<any>} */
  get: async (path, signal) => (await asked(path, { signal })).json(),

  /** @param {string} path @returns {Promise<{content: Uint8Array, version: string | null}>} */
  bytes: async (path) => {
    const answer = await asked(path, {});
    return { content: new Uint8Array(await answer.arrayBuffer()), version: answer.headers.get("X-Version") };
  },

  /** @param {string} path @param {unknown} body @returns {Promise<any>} */
  post: async (path, body) => (await asked(path, sent("POST", body))).json(),

  /** @param {string} path @param {unknown} body @returns {Promise<Blob>} */
  file: async (path, body) => (await asked(path, sent("POST", body))).blob(),

  /**
   * Writes a file: `version` is that of the file as it was read, null where it must not exist yet.
   * @param {string} path @param {unknown} body @param {{version: string | null}} options @returns {Promise<any>}
   */
  put: async (path, body, { version }) =>
    (await asked(path, sent("PUT", body, { "If-Match": version ?? "none" }))).json(),
};
