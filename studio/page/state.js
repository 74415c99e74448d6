// What the page knows: the scene, what is shown of it, and the answers so far.

export const app = {
  doc: null, // the scene and its past, see scene.js
  selected: 'target',
  tool: 'move',
  vertex: null,
  engine: 'native', // native; box2d: the other one, which is Bullet for a sheet; over, side: both
  own_gain: false, // the other engine searches for itself
  refines: true, // until the cloth is on the target
  alpha: null, // a gain tried by hand; null: the best
  // By engine: {flight, key, stale, best, best_throw, search, curve, pareto_front}; a key is the text of the scene
  // that an answer is of.
  results: {},
  time: null, // of the flight [s]; null: the arrival
  playing: false,
  loop: true,
  after: true,
  ghosts: true,
  forces: false,
  wires: false, // of a sheet, instead of its shaded faces
  errors: false, // of a sheet at arrival, as its color
  speed: 1,
};

export const engine_names = { native: 'native', box2d: 'Box2D', bullet: 'Bullet' };

export const scene = () => app.doc.scene;
export const is_sheet = () => scene().initial.vertices !== undefined;
// The engines that fly the scene: the project's own and the other.
export const other_engine = () => (is_sheet() ? 'bullet' : 'box2d');
export const engines = () => ['native', other_engine()];
export const shows = (engine) => app.engine === (engine === 'native' ? 'native' : 'box2d') || app.engine === 'over' || app.engine === 'side';
export const particles = () => (is_sheet() ? scene().initial.vertices.length : scene().particles);
// L of a throw [m].
export const length_of = (flight) => flight.cloth_length ?? flight.size;

const flight_after = 0.6; // of the arrival time, how long the cloth flies on
export const time_after = () => flight_after * scene().arrival_time;
export const end_time = () => scene().arrival_time + (app.after ? time_after() : 0);
export const now = () => app.time ?? scene().arrival_time;

// What control effort is measured in.
export const effort_unit = () => (scene().gravity > 0 ? '× weight' : '× m·L/t₀²');

// Why the cloth cannot be corrected off; empty if it can.
export function no_refining() {
  if (app.engine !== 'native') return 'It is for the native engine alone.';
  if (scene().reference !== 'morph') return 'It needs a control that follows a motion (morph).';
  if (!(scene().damping_ratio > 0)) return 'It needs a control with damping, ζ > 0.';
  return '';
}
