// A replay document made by hand: one map of two by three cells, one episode of three rows with one person.

/** Return a document's bytes, not packed. @param {number} [version] @returns {ArrayBuffer} */
export function document(version = 1) {
  /** @type {[string, string, number[], number[]][]} */
  const tables = [
    ["stamp", "float32", [3], [0, 1, 2]],
    ["pose", "float32", [3, 3], [0, 2, 4, 0, 0, 0, 3, -3, -3]],
    ["estimate", "float32", [3, 3], [0, 2, 4, 0, 0, 0, 0, 0, 0]],
    ["twist", "float32", [3, 3], [2, 2, 0, 0, 0, 0, 0, 0, 0]],
    ["in_contact", "uint8", [3], [0, 1, 0]],
    ["doors_open", "uint8", [2, 3], [0, 1, 1, 1, 1, 0]],
    ["people", "float32", [1, 2, 3], [NaN, 5, 6, NaN, 1, 1]],
    ["states", "int8", [1, 3], [0, 1, 1]],
    ["radii", "float32", [1], [0.3]],
    ["contact_stamp", "float32", [1], [1]],
    ["contact_position", "float32", [2, 1], [2, 0]],
    ["contact_kind", "int8", [1], [2]],
    ["contact_speed", "float32", [1], [0.5]],
    ["contact_caused", "uint8", [1], [0]],
    ["gait_begin", "float32", [2, 1], [0.5, 0]],
    ["considered_rows", "int32", [3], [0, 0, 2]],
    ["considered_offsets", "int32", [3], [0, 2, 4]],
    ["considered_points", "float32", [2, 4], [0, 1, 0, 2, 0, 0, 0, 1]],
    ["considered_costs", "float32", [2], [3, Infinity]],
    ["considered_chosen", "uint8", [2], [1, 0]],
    ["track_rows", "int32", [3], [0, 1, 1]],
    ["track_ids", "int32", [1], [7]],
    ["track_positions", "float32", [2, 1], [5, 1]],
    ["track_velocities", "float32", [2, 1], [1, 0]],
    ["track_radii", "float32", [1], [0.25]],
    ["team", "float32", [1, 3, 3], [8, 6, 4, 1, 1, 1, 3, -3, -3]],
    ["path", "float32", [2, 4], [0, 1, 0, 9, 0, 0, 5, 5]],
    ["path_offsets", "int32", [3], [0, 2, 4]],
    ["path_stamps", "float32", [2], [0, 1.5]],
  ];
  /** @type {Record<string, {type: string, shape: number[], offset: number}>} */ const arrays = {};
  let length = 8; // the map's cells come first
  for (const [name, type, shape, values] of tables) {
    arrays[name] = { type, shape, offset: length };
    length += Math.ceil((values.length * (type.endsWith("32") ? 4 : 1)) / 8) * 8;
  }
  const maps = [{ resolution: 0.5, origin: [-1, -2, 0], cells: { type: "uint8", shape: [2, 3], offset: 0 } }];
  const gait = {
    leg_radius: 0.06,
    stance_width: 0.2,
    step_width: 0.1,
    step_width_from: 1,
    walk_ratio: 0.006,
    apart: 1,
    settling: 0.3,
  };
  const marks = [
    { kind: "stand", stamp: 0.2, text: "stood 4.0 s: nothing was near", way: [] },
    {
      kind: "last avoidable moment",
      stamp: 0.5,
      text: "until here",
      way: [
        [0, 0],
        [0, 1],
        [1, 1],
      ],
    },
  ];
  const episodes = [{ name: "made", map: 0, goal: [0, 0], gait, marks, arrays }];
  const header = new TextEncoder().encode(JSON.stringify({ format: "arena-replay", version, maps, episodes }));
  const begin = Math.ceil((8 + header.length) / 8) * 8;
  const raw = new ArrayBuffer(begin + length);
  new Uint8Array(raw).set([...new TextEncoder().encode("ARPL")]);
  new DataView(raw).setUint32(4, header.length, true);
  new Uint8Array(raw).set(header, 8);
  new Uint8Array(raw).set([1, 0, 0, 1, 0, 2], begin);
  const kinds = { float32: Float32Array, int32: Int32Array, int8: Int8Array, uint8: Uint8Array };
  for (const [name, type, , values] of tables)
    new kinds[type](raw, begin + arrays[name].offset, values.length).set(values);
  return raw;
}
