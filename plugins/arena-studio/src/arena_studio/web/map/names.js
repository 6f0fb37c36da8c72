// Names of files.

/** The next name after a map's: hall.yaml, hall_2.yaml, hall_3.yaml. @param {string} path */
export function copyName(path) {
  const [, stem, number] = /^(.*?)(?:_(\d+))?(?:\.ya?ml)?$/.exec(path) ?? [path, path, "1"];
  return `${stem}_${Number(number ?? 1) + 1}.yaml`;
}
