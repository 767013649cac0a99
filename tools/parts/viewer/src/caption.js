// The texts on the stage.

/** Returns a line on the state of a robot at a time [s]. */
export function stateText(life, time) {
  if (life.shots.length === 0) return `${life.robot.status}: ${life.robot.reason}`;
  const shot = life.shots[life.shotAt(time)];
  const { springs, masses, gone, came } = shot;
  const texts = [shot.name, springs.length > 0 ? `${springs.length} springs` : `${masses.length} points`];
  if (gone.length + came > 0) texts.push(`${gone.length} removed, ${came} new`);
  if (life.way && time > life.way.begin.time) texts.push(wayText(life, time));
  return texts.join(" · ");
}

/** Says how far a robot has moved, of how much in all, and where to: "0.41 of 0.58 body lengths (0.12 m) along +x". */
function wayText(life, time) {
  const { length, total, direction } = life.way;
  const moved = life.movedAt(time);
  const lengths = `${(moved / length).toFixed(2)} of ${total.toFixed(2)} body lengths (${moved.toFixed(2)} m)`;
  const axes = direction.flatMap((part, i) => (Math.abs(part) > 0.38 ? [`${part < 0 ? "−" : "+"}${"xy"[i]}`] : []));
  return `${lengths} ${axes.length === 1 ? `along ${axes[0]}` : `between ${axes.join(" and ")}`}`;
}
