// Numbers for people.

export const digits = (x, n = 3) => {
  if (x === 0) return '0';
  const size = Math.abs(x);
  if (size >= 1e5 || size < 1e-4) return x.toExponential(1).replace('e-', 'e−').replace('e+', 'e');
  return Number(x.toPrecision(n)).toString();
};

// The same width while it changes.
export const steady = (x) =>
  x >= 0.01 && x < 1000 ? Number(x.toPrecision(3)).toFixed(Math.max(0, 2 - Math.floor(Math.log10(x)))) : digits(x);

export const metres = (x) =>
  x < 1e-6 ? '< 1 µm' : x < 1e-3 ? `${digits(1e6 * x, 2)} µm` : x < 1 ? `${digits(1e3 * x)} mm` : `${digits(x)} m`;

export const seconds = (s) => (s < 1 ? `${digits(1e3 * s, 2)} ms` : `${digits(s, 2)} s`);

export const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];
