// The reader of replay documents.

import assert from "node:assert/strict";
import { test } from "node:test";
import { gzipSync } from "node:zlib";

import { bytesOf, decode, unpack } from "arena/decode.js";

import { document } from "./made.js";

test("arrays lie where the header says", () => {
  const { maps, episodes } = decode(document());
  assert.deepEqual([...maps[0].cells.values], [1, 0, 0, 1, 0, 2]);
  assert.deepEqual([...episodes[0].arrays.stamp.values], [0, 1, 2]);
  assert.equal(episodes[0].arrays.people.rows, 3);
  assert.deepEqual([...episodes[0].arrays.path_offsets.values], [0, 2, 4]);
});

test("what is no document is said in one line", () => {
  assert.throws(() => decode(new ArrayBuffer(4)), /no replay document/);
  assert.throws(() => decode(new TextEncoder().encode("not a document").buffer), /no replay document/);
  assert.throws(() => decode(document(7)), /version 7; this viewer knows 1/);
});

test("packed bytes and base64 come back as they were", async () => {
  const packed = gzipSync(new Uint8Array([1, 2, 3]));
  assert.deepEqual([...new Uint8Array(await unpack(bytesOf(packed.toString("base64"))))], [1, 2, 3]);
});

test("a packed file that was cut off is refused", async () => {
  await assert.rejects(unpack(new Uint8Array(gzipSync(new Uint8Array(1000))).subarray(0, 12)));
});
