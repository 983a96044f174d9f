// Colours: those of meanings are variables of viewer.css, and each robot has a hue of its own for its trail and its
// plots.
//
// One place for both, so that a theme changes the page, its canvases and the scene together.
import {Color} from 'three';

// Kept, because the browser computes the styles of the page for each question.
const known = new Map<string, string>();
let themeOfKnown: string | undefined;

export function color(name: string): string {
  const {theme} = document.documentElement.dataset;
  if (theme !== themeOfKnown) known.clear();
  themeOfKnown = theme;
  let value = known.get(name);
  if (value === undefined) {
    value = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    known.set(name, value);
  }
  return value;
}

export function isDark(): boolean {
  return document.documentElement.dataset.theme === 'dark';
}

// Hues that lie far apart for robots that follow each other. `robot`: its index.
export function robotHue(robot: number): number {
  return (205 + robot * 137.508) % 360;
}

// For CSS and canvases, with a contrast of at least 3 : 1 on cards and on the ground.
export function robotColor(robot: number): string {
  return isDark() ? `hsl(${robotHue(robot).toFixed(1)}, 75%, 68%)` : `hsl(${robotHue(robot).toFixed(1)}, 80%, 36%)`;
}

export function robotColorOf(robot: number, target: Color): Color {
  return isDark() ? target.setHSL(robotHue(robot) / 360, 0.75, 0.68) : target.setHSL(robotHue(robot) / 360, 0.8, 0.36);
}
