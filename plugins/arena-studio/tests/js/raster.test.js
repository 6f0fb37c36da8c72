import assert from "node:assert/strict";
import { test } from "node:test";
import { flood, line, outline, polygon, rectangle, stroke, wall } from "../../src/arena_studio/web/map/raster.js";

/**
 * Draw and return rows of text, "#" where something was drawn.
 * @param {number} width
 * @param {number} height
 * @param {(fill: any) => void} paint
 */
function drawn(width, height, paint) {
  const cells = Array.from({ length: height }, () => Array(width).fill("."));
  paint((row, left, right) => {
    for (let column = Math.max(left, 0); column < Math.min(right, width); column++)
      if (cells[row]) cells[row][column] = "#";
  });
  return cells.map((row) => row.join(""));
}

test("a line passes from side to side, so that nothing slips through", () => {
  assert.deepEqual(
    drawn(4, 3, (fill) => line([0.5, 0.5], [3.5, 2.5], fill)),
    ["##..", ".##.", "..##"],
  );
  assert.deepEqual(
    drawn(4, 1, (fill) => line([3.5, 0.5], [0.5, 0.5], fill)),
    ["####"],
  );
  assert.deepEqual(
    drawn(1, 3, (fill) => line([0.5, 2.9], [0.5, 0.1], fill)),
    ["#", "#", "#"],
  );
});

test("random lines are connected over their sides and as long as they must be", () => {
  let seed = 1;
  const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
  for (let i = 0; i < 300; i++) {
    const [from, to] = [0, 1].map(() => /** @type {[number, number]} */ ([20 * random(), 20 * random()]));
    /** @type {number[][]} */ const cells = [];
    line(from, to, (row, left) => cells.push([left, row]));
    cells.slice(1).forEach(([x, y], k) => assert.equal(Math.abs(x - cells[k][0]) + Math.abs(y - cells[k][1]), 1));
    assert.deepEqual(cells[0], from.map(Math.floor));
    assert.deepEqual(cells.at(-1), to.map(Math.floor));
  }
});

test("a wall on the lines of the grid is as thick as was said, and its corners close", () => {
  const both = drawn(7, 6, (fill) => {
    wall([1, 1], [5, 1], 2, fill);
    wall([5, 1], [5, 4], 2, fill);
  });
  assert.deepEqual(both, ["######.", "######.", "....##.", "....##.", "....##.", "......."]);
  assert.deepEqual(drawn(4, 3, (fill) => wall([0.5, 1.5], [3.5, 1.5], 1, fill))[1], "####");
});

test("a round brush paints the cells whose centres it covers", () => {
  assert.deepEqual(
    drawn(5, 5, (fill) => stroke([2.5, 2.5], [2.5, 2.5], 1.5, fill)),
    [".....", ".###.", ".###.", ".###.", "....."],
  );
  assert.deepEqual(
    drawn(6, 3, (fill) => stroke([1.5, 1.5], [4.5, 1.5], 1.2, fill)),
    [".####.", "######", ".####."],
  );
});

test("a rectangle has at least one cell, an outline is hollow", () => {
  assert.deepEqual(
    drawn(3, 2, (fill) => rectangle([1.2, 0.3], [1.3, 0.4], fill)),
    [".#.", "..."],
  );
  assert.deepEqual(
    drawn(4, 3, (fill) => rectangle([3, 2], [1, 0], fill)),
    [".##.", ".##.", "...."],
  );
  const hollow = drawn(6, 6, (fill) =>
    outline(
      [
        [1, 1],
        [5, 1],
        [5, 5],
        [1, 5],
      ],
      2,
      fill,
    ),
  );
  assert.deepEqual(hollow, ["######", "######", "##..##", "##..##", "######", "######"]);
});

test("a polygon holds the cells whose centres lie in it", () => {
  assert.deepEqual(
    drawn(4, 4, (fill) =>
      polygon(
        [
          [0, 0],
          [4, 0],
          [0, 4],
        ],
        fill,
      ),
    ),
    ["###.", "##..", "#...", "...."],
  );
  assert.deepEqual(
    drawn(4, 2, (fill) =>
      polygon(
        [
          [0, 0],
          [4, 0],
          [4, 2],
          [0, 2],
        ],
        fill,
      ),
    ),
    ["####", "####"],
  );
});

test("filling stops at other kinds and does not go round corners", () => {
  const rows = ["..#..", ".#...", "#...."];
  const cells = Uint8Array.from(rows.join(""), (c) => (c === "#" ? 1 : 0));
  const kinds = new Uint8Array(256);
  kinds[1] = 1;
  assert.deepEqual(
    drawn(5, 3, (fill) => flood({ width: 5, height: 3, cells }, kinds, 0, 0, fill)),
    ["##...", "#....", "....."],
  );
  assert.deepEqual(
    drawn(5, 3, (fill) => flood({ width: 5, height: 3, cells }, kinds, 9, 0, fill)),
    [".....", ".....", "....."],
  );
});

test("filling goes through shades of one kind", () => {
  const cells = Uint8Array.of(250, 254, 0, 254);
  const kinds = new Uint8Array(256).fill(7);
  kinds[0] = 1;
  assert.deepEqual(
    drawn(4, 1, (fill) => flood({ width: 4, height: 1, cells }, kinds, 0, 0, fill)),
    ["##.."],
  );
});
