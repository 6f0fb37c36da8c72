// What stands: floor, walls, obstacles, goal. Lengths in m; z goes up, as everywhere in the solid world.

export const WALL = 1.0; // m, as in pictures of `arena render`: a camera behind the robot sees over them
const OBSTACLE = 0.8; // m
const TILE = 1.0; // m
const SMALL = 12.0; // m²; what stands free and covers less is no wall

/**
 * Cover some cells of a map with few rectangles: runs of a row, and equal runs above each other.
 * @param {ArrayLike<number>} cells by rows from below @param {number} width @param {number} height
 * @param {(cell: number) => boolean} [wanted] which cells: the occupied ones
 * @returns {number[][]} column, row, columns, rows
 */
export function rectangles(cells, width, height, wanted = (cell) => cell === 1) {
  const found = [];
  /** @type {Map<number, number[]>} */ let below = new Map();
  for (let j = 0; j < height; j++) {
    /** @type {Map<number, number[]>} */ const here = new Map();
    for (let i = 0; i < width; i++) {
      if (!wanted(cells[j * width + i])) continue;
      const begin = i;
      while (i < width && wanted(cells[j * width + i])) i++;
      const key = begin * (width + 1) + i;
      const run = below.get(key) ?? [begin, j, i - begin, 0];
      if (!run[3]) found.push(run);
      run[3] += 1;
      here.set(key, run);
    }
    below = here;
  }
  return found;
}

/**
 * Tell of each occupied cell whether it belongs to what stands free and is small, as shelves and pillars do: all that
 * hangs together with it covers less than ``most`` cells and does not reach the map's edge.
 * @param {ArrayLike<number>} cells @param {number} width @param {number} height @param {number} most
 * @returns {Uint8Array} 1 where it does
 */
export function freeStanding(cells, width, height, most) {
  const found = new Uint8Array(cells.length);
  const seen = new Uint8Array(cells.length);
  for (let first = 0; first < cells.length; first++) {
    if (seen[first] || cells[first] !== 1) continue;
    const members = [first];
    seen[first] = 1;
    let atEdge = false;
    for (let k = 0; k < members.length; k++) {
      const [i, j] = [members[k] % width, Math.floor(members[k] / width)];
      atEdge ||= i === 0 || j === 0 || i === width - 1 || j === height - 1;
      for (let b = Math.max(0, j - 1); b <= Math.min(height - 1, j + 1); b++)
        for (let a = Math.max(0, i - 1); a <= Math.min(width - 1, i + 1); a++) {
          const other = b * width + a;
          if (seen[other] || cells[other] !== 1) continue;
          seen[other] = 1;
          members.push(other);
        }
    }
    if (!atEdge && members.length < most) for (const member of members) found[member] = 1;
  }
  return found;
}

/**
 * Walls and floor of a map.
 * @param {any} three @param {any} map @param {Record<string, string>} colours
 */
export function building(three, map, colours) {
  const group = new three.Group();
  const [height, width] = map.cells.shape;
  const { resolution: size, origin } = map;
  const boxes = rectangles(map.cells.values, width, height);
  const free = freeStanding(map.cells.values, width, height, SMALL / size ** 2);
  const tint = { wall: new three.Color(colours.wall), shelf: new three.Color(colours.obstacle) };
  const walls = new three.InstancedMesh(new three.BoxGeometry(1, 1, 1), new three.MeshLambertMaterial(), boxes.length);
  const matrix = new three.Matrix4();
  boxes.forEach(([i, j, columns, rows], k) => {
    matrix.makeScale(columns * size, rows * size, WALL);
    matrix.setPosition((i + columns / 2) * size, (j + rows / 2) * size, WALL / 2);
    walls.setMatrixAt(k, matrix);
    walls.setColorAt(k, free[j * width + i] ? tint.shelf : tint.wall);
  });
  walls.castShadow = walls.receiveShadow = true;
  group.add(walls, ground(three, map, colours), tiles(three, width * size, height * size, colours));
  group.position.set(origin[0], origin[1], 0);
  group.rotation.z = origin[2];
  return group;
}

/** The floor under all cells that are known. @type {(three: any, map: any, colours: Record<string, string>) => any} */
function ground(three, map, colours) {
  const [height, width] = map.cells.shape;
  const size = map.resolution;
  const parts = rectangles(map.cells.values, width, height, (cell) => cell !== 2);
  const material = new three.MeshLambertMaterial({ color: colours.floor });
  const floor = new three.InstancedMesh(new three.PlaneGeometry(1, 1), material, parts.length);
  const matrix = new three.Matrix4();
  parts.forEach(([i, j, columns, rows], k) => {
    matrix.makeScale(columns * size, rows * size, 1);
    matrix.setPosition((i + columns / 2) * size, (j + rows / 2) * size, 0);
    floor.setMatrixAt(k, matrix);
  });
  floor.receiveShadow = true;
  return floor;
}

/** Lines of tiles of a metre. @param {any} three @param {number} width @param {number} height @param {any} colours */
function tiles(three, width, height, colours) {
  const ends = [];
  for (let x = TILE; x < width; x += TILE) ends.push(x, 0, 0.004, x, height, 0.004);
  for (let y = TILE; y < height; y += TILE) ends.push(0, y, 0.004, width, y, 0.004);
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(new Float32Array(ends), 3));
  const faint = { color: colours.ink, transparent: true, opacity: 0.09, depthWrite: false };
  return new three.LineSegments(geometry, new three.LineBasicMaterial(faint));
}

/** A floor without a map, under a window. @param {any} three @param {number[]} window @param {any} colours */
export function bareFloor(three, window, colours) {
  const [left, right, bottom, top] = window;
  const material = new three.MeshLambertMaterial({ color: colours.floor });
  const floor = new three.Mesh(new three.PlaneGeometry(right - left + 4, top - bottom + 4), material);
  floor.position.set((left + right) / 2, (bottom + top) / 2, 0);
  floor.receiveShadow = true;
  return floor;
}

/** A disc or a polygon that stands. @param {any} three @param {any} obstacle @param {any} colours */
export function standing(three, obstacle, colours) {
  const points = /** @type {number[][]} */ (obstacle.vertices_xy);
  if (points.length > 2) return upright(three, points, OBSTACLE, colours.obstacle);
  const geometry = new three.CylinderGeometry(obstacle.radius, obstacle.radius, OBSTACLE, 32).rotateX(Math.PI / 2);
  const mesh = new three.Mesh(geometry, new three.MeshLambertMaterial({ color: colours.obstacle }));
  mesh.position.set(points[0][0], points[0][1], OBSTACLE / 2);
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

/** A polygon as a body. @type {(three: any, points: number[][], height: number, colour: string) => any} */
export function upright(three, points, height, colour) {
  const shape = new three.Shape(points.map(([x, y]) => new three.Vector2(x, y)));
  const geometry = new three.ExtrudeGeometry(shape, { depth: height, bevelEnabled: false });
  const mesh = new three.Mesh(geometry, new three.MeshLambertMaterial({ color: colour }));
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

/** The goal: its disc on the floor, and a pennant. @param {any} three @param {any} said @param {any} colours */
export function goalOf(three, said, colours) {
  const group = new three.Group();
  const flat = new three.MeshBasicMaterial({ color: colours.goal, transparent: true, opacity: 0.65 });
  const disc = new three.Mesh(new three.CircleGeometry(said.goal_radius, 48), flat);
  disc.position.z = 0.012;
  const pole = new three.Mesh(
    new three.CylinderGeometry(0.012, 0.012, 1.1, 8).rotateX(Math.PI / 2),
    new three.MeshLambertMaterial({ color: colours.soft }),
  );
  pole.position.z = 0.55;
  const cloth = new three.Shape([new three.Vector2(0, 0), new three.Vector2(0.32, 0.1), new three.Vector2(0, 0.2)]);
  const pennant = new three.Mesh(
    new three.ShapeGeometry(cloth).rotateX(Math.PI / 2),
    new three.MeshLambertMaterial({ color: colours.goal, side: three.DoubleSide }),
  );
  pennant.position.z = 0.88;
  pole.castShadow = pennant.castShadow = true;
  group.add(disc, pole, pennant);
  group.position.set(said.goal[0], said.goal[1], 0);
  return group;
}
