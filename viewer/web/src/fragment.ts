// The fragment of the address, for links to a view: #robot=r0&view=top&follow=1&rays=all&tick=120
// quality=full draws everything, however slow that is.
export interface Fragment {
  robot?: string;
  view?: string;
  follow?: boolean;
  rays?: string;
  tick?: number;  // a past one
  fullQuality?: boolean;
  smooth?: boolean;  // false: bodies are drawn at the poses received, and not on their way there
}

export function readFragment(): Fragment {
  const values = new URLSearchParams(location.hash.slice(1));
  const fragment: Fragment = {};
  if (values.get('robot')) fragment.robot = values.get('robot')!;
  if (values.get('view')) fragment.view = values.get('view')!;
  if (values.get('rays')) fragment.rays = values.get('rays')!;
  if (/^\d+$/.test(values.get('tick') ?? '')) fragment.tick = Number(values.get('tick'));
  fragment.fullQuality = values.get('quality') === 'full';
  fragment.smooth = values.get('smooth') !== '0';
  fragment.follow = values.get('follow') === '1';
  return fragment;
}

export function writeFragment(fragment: Fragment): void {
  const values = new URLSearchParams();
  if (fragment.robot) values.set('robot', fragment.robot);
  if (fragment.view && fragment.view !== 'orbit') values.set('view', fragment.view);
  if (fragment.rays) values.set('rays', fragment.rays);
  if (fragment.tick !== undefined) values.set('tick', String(fragment.tick));
  if (fragment.follow) values.set('follow', '1');
  if (fragment.smooth === false) values.set('smooth', '0');
  if (fragment.fullQuality) values.set('quality', 'full');
  const text = values.toString();
  history.replaceState(null, '', text ? `#${text}` : location.pathname + location.search);
}
