// The page of `troupe view`: it connects the parts, and decides which of them gets a message.
//
// Parts know the connection and what they show, not each other. An update of the gateway is applied to the Run at once,
// and the scene is drawn at the next frame; panels are refreshed at most ten times a second, because text costs more
// than a picture.
import {Agents, agentText} from './agents';
import {Connection, type AgentInfo, type Proof, type SessionInfo} from './connection';
import {Download} from './download';
import {Dock, isTab, type Tab} from './dock';
import {allow, byId, setOn, setText, tellRefusals, throttled, toast} from './dom';
import {Driving, GripperButtons} from './driving';
import {Editing} from './editing';
import {DoorButtons} from './doors';
import {EntityPanel} from './entity_panel';
import {FileEditor} from './file_editor';
import {GifRecording} from './gif_recording';
import {save, Video} from './graphics';
import {LevelChoice} from './levels';
import type {Message, RunEvent, TimeSpan} from './protocol';
import {EndCard} from './end_card';
import {EventItems} from './event_items';
import {EventList} from './events';
import {Expectations} from './expectations';
import {Experiment} from './experiment';
import {Plots} from './plots';
import {findEntity, nameOf, Run, sameEntity, type Entity} from './run';
import {WorldScene, type ViewName} from './scene';
import {installTestInterface} from './test_interface';
import {ThingList} from './thing_list';
import {TimeBar} from './time_bar';
import {Popup, Toolbar} from './toolbar';
import {VehiclePanel} from './vehicle_panel';
import {Vehicles, type VehicleState} from './vehicles';

// The fragment of the address, for links to a view:
// #robot=r0&tab=sensors&view=top&levels=L2&follow=1&rays=all&tick=120
// quality=full draws everything, however slow that is.

export interface Fragment {
  robot?: string;
  view?: string;
  levels?: string;  // of a building: stacked, beside, or the name of the one that is shown; none: as usual
  follow?: boolean;
  rays?: string;
  tab?: string;  // of the column
  tick?: number;  // a past one
  camera?: string;  // where it is; none: as usual
  fullQuality?: boolean;
  smooth?: boolean;  // false: bodies are drawn at the poses received, and not on their way there
}

export function readFragment(): Fragment {
  const values = new URLSearchParams(location.hash.slice(1));
  const fragment: Fragment = {};
  if (values.get('robot')) fragment.robot = values.get('robot')!;
  if (values.get('view')) fragment.view = values.get('view')!;
  if (values.get('levels')) fragment.levels = values.get('levels')!;
  if (values.get('rays')) fragment.rays = values.get('rays')!;
  if (values.get('tab')) fragment.tab = values.get('tab')!;
  if (/^\d+$/.test(values.get('tick') ?? '')) fragment.tick = Number(values.get('tick'));
  if (values.get('camera')) fragment.camera = values.get('camera')!;
  fragment.fullQuality = values.get('quality') === 'full';
  fragment.smooth = values.get('smooth') !== '0';
  fragment.follow = values.get('follow') === '1';
  return fragment;
}

function fragmentText(fragment: Fragment): string {
  const values = new URLSearchParams();
  if (fragment.robot) values.set('robot', fragment.robot);
  if (fragment.view && fragment.view !== 'orbit') values.set('view', fragment.view);
  if (fragment.levels) values.set('levels', fragment.levels);
  if (fragment.rays) values.set('rays', fragment.rays);
  if (fragment.tab && fragment.tab !== 'state') values.set('tab', fragment.tab);
  if (fragment.tick !== undefined) values.set('tick', String(fragment.tick));
  if (fragment.follow) values.set('follow', '1');
  if (fragment.smooth === false) values.set('smooth', '0');
  if (fragment.fullQuality) values.set('quality', 'full');
  if (fragment.camera) values.set('camera', fragment.camera);
  return values.toString();
}

export function writeFragment(fragment: Fragment): void {
  const text = fragmentText(fragment);
  history.replaceState(null, '', text ? `#${text}` : location.pathname + location.search);
}

// The badge of a page that computes its recording itself.
function showProof(proof: Proof): void {
  const badge = byId('proof');
  badge.hidden = false;
  badge.classList.toggle('idle', !proof.done);
  badge.classList.toggle('lost', proof.problem !== '');
  const equal = proof.equal.toLocaleString('en');
  setText(badge, proof.problem ? (proof.tick === undefined ? 'not equal' : `differs at tick ${proof.tick}`)
    : proof.done ? `${equal} states: all equal` : `${equal} of ${proof.states.toLocaleString('en')} states equal`);
  badge.title = proof.problem ||
    'This page has computed these states again from the recorded inputs: each has the recorded hash.';
}

class Viewer {
  // First, so that the world is on its way while the graphics start.
  private readonly connection = new Connection({
    onOpen: () => {
      this.setOnline(true);
      this.sendSelection();
    },
    onClosed: () => {
      this.timeBar.timeline.reset();
      this.setOnline(false);
    },
    onSession: info => this.onSession(info),
    onStatus: status => {
      if (this.run) this.run.status = status;
      this.refresh();
    },
    onTimeline: spans => {
      this.spans = spans;
      if (this.run) this.run.spans = spans;
      this.refresh();
    },
    onMessage: message => this.onMessage(message),
    onProof: proof => showProof(proof),
    onScenario: scenario => {
      this.timeBar.timeline.reset();  // a run that begins
      this.experiment.set(scenario);
      this.download.set(scenario);
      this.toolbar.layOut();
    },
  });
  private run: Run | null = null;
  private spans: TimeSpan[] = [];
  private selected: Entity | null = null;
  private wantedName: string;  // selected as soon as the world has it
  private wantedLevels: string;  // shown as soon as there is a world
  private wantedTick: number | undefined;  // shown as soon as there is a state
  private wantedCamera: string;  // the same
  private allRays = false;
  private online = false;
  private info: SessionInfo | null = null;
  private file: FileEditor | null = null;  // of `troupe edit`
  private readonly scene = new WorldScene(byId('scene'), readFragment().fullQuality ?? false);
  private readonly systemTheme = matchMedia('(prefers-color-scheme: dark)');
  private readonly dock = new Dock(() => {
    this.remember();
    this.refresh();
  });
  private readonly toolbar = new Toolbar();
  private readonly levels = new LevelChoice(
    byId('levels'), choice => this.scene.chooseLevels(choice));
  private readonly help = new Popup(byId('help-open'), byId('help'));
  private readonly timeBar: TimeBar;
  private readonly editing: Editing;
  private readonly driving: Driving;
  private readonly grippers: GripperButtons;
  private readonly doors: DoorButtons;
  private readonly video: Video;
  private readonly panel = new EntityPanel();
  private readonly agents: Agents;
  private readonly vehicles: Vehicles;
  private readonly vehiclePanel = new VehiclePanel();
  private readonly things = new ThingList({
    select: entity => this.selectAndCenter(entity),
    showLevel: name => this.scene.chooseLevels(name),
    send: (command, fields) => void this.sendSwitch(command, fields),
    refresh: () => this.refresh(),
    hint: robot => this.agentHint(robot),
  });
  private readonly eventItems = new EventItems();
  private readonly events = new EventList(this.eventItems, event => this.showEvent(event), () => this.timeBar.show(this.run));
  private readonly plots = new Plots(
    byId('plots'), this.connection, position => this.timeBar.timeline.seek(position),
    robot => this.agents.of(robot)?.answer_seconds ?? null, () => this.fileName());
  private readonly expectations = new Expectations(
    this.connection, position => this.timeBar.timeline.seek(position), () => this.refresh());
  private readonly experiment = new Experiment(this.connection);
  private readonly download = new Download();
  private readonly endCard = new EndCard(this.connection, {
    info: () => this.info,
    select: name => {
      this.wantedName = name;
      this.selectWanted();
    },
    replay: () => this.timeBar.timeline.replay(),
  });
  private readonly refresh = throttled(() => this.scene.quality.panelPeriod, () => this.refreshPanels());

  constructor() {
    this.agents = new Agents(this.connection, () => this.refresh());
    this.vehicles = new Vehicles(this.connection, this.agents, () => this.refresh());
    this.timeBar = new TimeBar(this.connection, this.eventItems, () => this.remember());
    this.editing = new Editing(this.scene, this.connection, {
      run: () => this.run,
      selected: () => this.selected,
      select: entity => this.select(entity),
      selectNamed: name => {
        this.wantedName = name;
        this.selectWanted();
      },
      driveTo: point => this.driving.driveTo(point),
    });
    this.driving = new Driving(this.connection, {run: () => this.run, robot: () => this.selectedRobot});
    this.grippers = new GripperButtons(this.connection);
    this.doors = new DoorButtons(this.connection);
    new GifRecording(this.scene.canvas, into => this.scene.drawInto(into), () => this.fileName());
    this.video = new Video(this.scene.canvas, () => this.fileName());
    const fragment = readFragment();
    this.wantedName = fragment.robot ?? '';
    this.allRays = fragment.rays === 'all';
    this.wantedTick = fragment.tick;
    this.wantedLevels = fragment.levels ?? '';
    this.wantedCamera = fragment.camera ?? '';
    this.scene.levelsChanged = () => this.showLevels();
    if (fragment.tab && isTab(fragment.tab)) this.dock.show(fragment.tab);
    this.scene.following = fragment.follow ?? false;
    this.scene.motion.enabled = fragment.smooth ?? true;
    this.setView(fragment.view === 'top' ? 'top' : 'orbit');
    tellRefusals();
    Popup.install();
    this.bindButtons();
    this.bindKeys();
    this.applyTheme();
    this.showToggles();
    this.showConnection();
    installTestInterface({
      run: () => this.run,
      connected: () => this.online && (this.info?.connected ?? false),
      select: name => {
        this.wantedName = name;
        this.selectWanted();
      },
      plots: () => this.plots,
      file: () => this.file,
    }, this.scene, this.connection);
  }

  // Of a zone or a lane.
  private async sendSwitch(command: string, fields: object): Promise<void> {
    if (this.info?.view_only) return;
    const reply = await this.connection.request(command, fields);
    if (!reply.done) toast(reply.problem, true);
  }

  private onSession(info: SessionInfo): void {
    this.info = info;
    document.title = `${info.session} · Troupe`;
    setText(byId('session'), info.session);
    this.timeBar.setViewOnly(info.view_only);
    this.timeBar.timeline.setRecording(info.recording);
    this.editing.setViewOnly(info.view_only);
    this.driving.setViewOnly(info.view_only);
    this.grippers.setViewOnly(info.view_only);
    this.doors.setViewOnly(info.view_only);
    byId('view-only').hidden = !info.view_only;
    if (info.editor) this.editFile(info.view_only);
    this.toolbar.layOut();
    this.showConnection();
    this.refresh();
  }

  private editFile(viewOnly: boolean): void {
    if (this.file) {
      void this.file.load();  // after a connection was lost
      return;
    }
    this.file = new FileEditor(this.connection, this.scene, this.editing, {
      selectName: (name, center) => {
        const entity = this.run ? findEntity(this.run.world, name) : null;
        this.select(entity);
        if (!entity) this.wantedName = name;  // the world that has it is on its way
        if (entity && center) this.scene.centerOn(entity);
        this.file?.select(name);
      },
      markNames: names => {
        const run = this.run;
        this.scene.alsoSelected = run ? names.flatMap(name => findEntity(run.world, name) ?? []) : [];
        if (run?.hasState) this.scene.show(run, this.selected);
      },
      run: () => this.run,
    }, viewOnly);
  }

  private onMessage(message: Message): void {
    if (message.kind === 'world') {
      const before = this.run;
      const name = this.selected && before ? nameOf(before.world, this.selected) : '';
      this.run = new Run(message.world, before);
      this.run.spans = this.spans;
      this.selected = null;
      if (name && !this.wantedName) this.wantedName = name;
      this.scene.setWorld(message.world, before !== null && before.world.name === message.world.name);
      byId('traffic').hidden = message.world.laneGraphs.length === 0;
      this.toolbar.layOut();
      if (this.wantedLevels || before === null) this.scene.chooseLevels(this.wantedLevels || this.usualLevels);
      this.wantedLevels = '';
      this.file?.worldChanged();
      this.timeBar.show(this.run);  // its buttons belong to this run, not to one that is over
      return;
    }
    if (!this.run || message.update.world !== this.run.world.number) return;
    const first = !this.run.hasState;
    this.run.apply(message.update);
    this.timeBar.timeline.received(this.run);
    if (first) {
      this.selectWanted();
      if (this.file && !this.selected) this.wantedName = '';
      if (this.wantedTick !== undefined) this.timeBar.timeline.seekTick(this.wantedTick);
      this.wantedTick = undefined;
      this.timeBar.show(this.run);
    }
    this.scene.show(this.run, this.selected);
    if (first && this.wantedCamera) {
      this.scene.setCamera(this.wantedCamera);
      this.wantedCamera = '';
    }
    this.panel.note(this.run, this.selected);
    this.refresh();
  }

  // How the levels of a building are shown at first: side by side, because the highest hides the others. An editor's
  // tools are at their true heights.
  private get usualLevels(): string {
    return this.scene.levels.list.length > 1 && !this.file ? 'beside' : 'stacked';
  }

  private get selectedRobot(): number {
    return this.selected?.kind === 'robot' ? this.selected.index : -1;
  }

  private fileName(): string {
    return `${this.info?.session ?? 'troupe'}-${this.run?.tick ?? 0}`;
  }

  private selectWanted(): void {
    const entity = this.run && this.wantedName ? findEntity(this.run.world, this.wantedName) : null;
    if (entity) this.select(entity);
  }

  private select(entity: Entity | null): void {
    this.wantedName = '';
    if (sameEntity(entity, this.selected)) return;
    this.driving.set(false);
    this.selected = entity;
    this.file?.select(entity && this.run ? nameOf(this.run.world, entity) : '');
    this.sendSelection();
    if (this.run) this.scene.show(this.run, entity);
    if (entity && this.dock.tab === 'robots') this.dock.show('state');
    this.remember();
    this.refresh();
  }

  private selectAndCenter(entity: Entity): void {
    this.select(entity);
    this.scene.centerOn(entity);
  }

  private showEvent(event: RunEvent): void {
    const entity = this.run && event.robot ? findEntity(this.run.world, event.robot) : null;
    if (entity) this.selectAndCenter(entity);
    this.timeBar.timeline.seek(event.position);
  }

  private sendSelection(): void {
    const name = this.run && this.selected?.kind === 'robot' ? this.run.world.robots[this.selected.index].name : '';
    this.connection.select(this.allRays ? 'all' : name ? [name] : [], name, this.scene.traffic.visible);
  }

  private refreshPanels(): void {
    if (this.run) this.eventItems.update(this.run.events, this.run.world.interval);
    this.timeBar.show(this.run);
    if (!this.run?.hasState) return;
    this.things.show(this.run, this.selected, this.scene.levels);
    this.panel.show(this.run, this.selected, this.agentOf(this.selectedRobot));
    const vehicle = this.vehicleState;
    this.vehiclePanel.show(vehicle);
    this.scene.setVehicle(this.selectedRobot, vehicle);
    this.grippers.show(this.run, this.selectedRobot);
    this.doors.show(this.run, this.selected);
    this.showRefusals();
    this.events.count(this.run);
    if (this.dock.tab === 'events') this.events.show(this.run, this.selected ? nameOf(this.run.world, this.selected) : '');
    setText(byId('world-name'), this.run.world.name);
    if (this.file) return;
    this.plots.show(this.run, this.selectedRobot);
    this.expectations.show(this.run, this.info);
    this.endCard.show(this.run);
    this.experiment.show(this.run);
  }

  // What is not possible now, and why.
  private showRefusals(): void {
    if (this.file) return;
    const info = this.info;
    const refusal = info?.view_only ? 'This page only shows the run: it was started with --view-only.'
      : info?.recording ? 'A recording cannot be changed. "troupe run FILE --from-tick T" continues it as a run.'
      : !this.online ? 'The program that serves this page has ended.'
      : this.run?.over ? 'The run is over.'
      : this.run?.past ? 'This is a past state. "Live" returns to the run.' : '';
    for (const id of ['move', 'add', 'undo', 'redo', 'rename', 'delete']) allow(id, refusal);
    const robot = this.selectedRobot >= 0 ? '' : 'Objects cannot be driven: select a robot.';
    for (const id of ['drive', 'send']) allow(id, refusal || robot);
    this.grippers.refuse(refusal);
    this.doors.refuse(refusal);
    allow('follow', this.selected ? '' : 'Select the robot or the object to follow.');
  }

  // The service of the run can be asked about its newest state.
  private get isLive(): boolean {
    return this.run !== null && this.online && !this.file && !this.info?.recording && !this.run.past && !this.run.over;
  }

  // The agent of a robot of the live run; a recording has none.
  private agentOf(robot: number): AgentInfo | null {
    return this.run && robot >= 0 && this.isLive ? this.agents.of(this.run.world.robots[robot].name) : null;
  }

  // Of the selected robot; null: it is no vehicle, or has sent none.
  private get vehicleState(): VehicleState | null {
    const robot = this.selectedRobot;
    return this.run && robot >= 0 && this.online && !this.file ? this.vehicles.of(this.run, robot, this.isLive) : null;
  }

  private agentHint(robot: string): string {
    const agent = this.agentOf(this.run?.world.robots.findIndex(r => r.present && r.name === robot) ?? -1);
    return agent ? agentText(agent) : '';
  }

  // Without the program that serves the page its last state stays, and nothing that would ask the program is offered.
  private setOnline(online: boolean): void {
    this.online = online;
    this.timeBar.setOnline(online);
    this.endCard.setOnline(online);
    this.showConnection();
    this.refresh();
  }

  private showConnection(): void {
    const overlay = byId('overlay');
    const text = !this.online ? 'Connecting to the viewer …'
      : this.info?.problem ? `Cannot follow the run: ${this.info.problem}`
      : !this.info?.connected ? `Waiting for a run in session ${this.info?.session ?? ''} …` : '';
    overlay.hidden = text === '' || (this.run?.over ?? false);
    setText(byId('overlay-text'), text);
    byId('scene').classList.toggle('stale', text !== '');
  }

  private setView(view: ViewName): void {
    this.scene.setView(view);
    setOn('view-orbit', view === 'orbit');
    setOn('view-top', view === 'top');
  }

  private showLevels(): void {
    this.levels.show(this.scene.levels);
    this.toolbar.layOut();
    this.remember();
    if (this.run?.hasState) this.scene.show(this.run, this.selected);
  }

  // The user's choice, or else the system's.
  private applyTheme(): void {
    const chosen = localStorage.getItem('theme');
    const system = this.systemTheme.matches ? 'dark' : 'light';
    document.documentElement.dataset.theme = chosen === 'light' || chosen === 'dark' ? chosen : system;
    this.scene.applyTheme();
    this.refresh();  // drawings have the colours of the theme
  }

  private toggleTheme(): void {
    localStorage.setItem('theme', document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
    this.applyTheme();
  }

  private remember(): void {
    writeFragment(this.fragment());
  }

  private fragment(): Fragment {
    const name = this.run && this.selected ? nameOf(this.run.world, this.selected) : this.wantedName;
    return {
      robot: name, view: this.scene.view, levels: this.wantedLevels || (this.scene.levels.choice === this.usualLevels ? '' : this.scene.levels.choice), follow: this.scene.following, rays: this.allRays ? 'all' : '',
      tab: this.dock.tab,
      fullQuality: this.scene.quality.fixed,
      smooth: this.scene.motion.enabled,
      tick: this.timeBar.timeline.inPast ? this.run?.tick ?? this.wantedTick : this.wantedTick,
    };
  }

  // A link to the state, the selection and the view of now, for another browser that reaches this address. A phone offers its
  // own ways to pass it on.
  private async share(): Promise<void> {
    const text = fragmentText({...this.fragment(), ...(this.run?.hasState && !this.file ? {tick: this.run.tick} : {}), camera: this.scene.cameraText});
    const url = `${location.href.replace(/#.*/, '')}#${text}`;
    if (matchMedia('(pointer: coarse)').matches && navigator.share) {
      await navigator.share({title: document.title, url}).catch(() => {});
      return;
    }
    try {
      await navigator.clipboard.writeText(url);
      toast('The link is copied: it shows this tick and view');
    } catch {
      window.prompt('The link to this tick and view', url);
    }
  }

  private showToggles(): void {
    setOn('rays', this.allRays);
    setOn('names', this.scene.labels.visible);
    setOn('follow', this.scene.following);
    setOn('trails', this.scene.trails.visible);
    setOn('traffic', this.scene.traffic.visible);
    document.body.classList.toggle('trails', this.scene.trails.visible);
  }

  private changed(): void {
    this.showToggles();
    this.remember();
    if (this.run) this.scene.show(this.run, this.selected);
  }

  private takePicture(): void {
    const [width = 0, height = 0] = byId<HTMLSelectElement>('picture-size').value.split('x').map(Number);
    save(this.scene.picture(width, height), `${this.fileName()}.png`);
    toast('The picture is saved');
  }

  private bindButtons(): void {
    const bind = (id: string, action: () => void): void => {
      byId(id).onclick = action;
    };
    bind('view-orbit', () => {
      this.setView('orbit');
      this.remember();
    });
    bind('view-top', () => {
      this.setView('top');
      this.remember();
    });
    bind('home', () => this.scene.home());
    bind('theme', () => this.toggleTheme());
    bind('picture', () => this.takePicture());
    bind('share', () => void this.share());
    bind('names', () => {
      this.scene.labels.visible = !this.scene.labels.visible;
      this.changed();
    });
    bind('trails', () => {
      this.scene.trails.visible = !this.scene.trails.visible;
      this.changed();
    });
    bind('traffic', () => {
      this.scene.traffic.visible = !this.scene.traffic.visible;
      this.sendSelection();
      this.changed();
    });
    bind('help-open', () => this.help.toggle());
    bind('help-close', () => this.help.set(false));
    bind('time-more', () => {
      const open = byId('bottom').classList.toggle('more');
      byId('time-more').setAttribute('aria-expanded', String(open));
    });
    bind('rename', () => void this.editing.renameSelected());
    bind('rays', () => {
      this.allRays = !this.allRays;
      this.sendSelection();
      this.changed();
    });
    bind('follow', () => {
      this.scene.following = !this.scene.following;
      this.changed();
    });
    bind('panel-close', () => this.select(null));
    byId('robot-search').oninput = () => this.refresh();
    this.systemTheme.addEventListener('change', () => this.applyTheme());
  }

  // Selects the robot `step` places after the selected one.
  private selectNext(step: number): void {
    const robots = this.run?.world.robots.flatMap((robot, i) => (robot.present ? [i] : [])) ?? [];
    if (robots.length === 0) return;
    const at = robots.indexOf(this.selectedRobot);
    const next = at < 0 ? (step > 0 ? 0 : robots.length - 1) : (at + step + robots.length) % robots.length;
    this.selectAndCenter({kind: 'robot', index: robots[next]});
  }

  private bindKeys(): void {
    const tabs: Tab[] = ['robots', 'state', 'sensors', 'events'];
    const actions: Record<string, () => void> = {
      ' ': () => this.timeBar.toggle(),
      '.': () => this.timeBar.step(1),
      'o': () => byId('view-orbit').click(),
      't': () => byId('view-top').click(),
      'h': () => this.scene.home(),
      'e': () => this.levels.next(this.scene.levels, 0),
      'PageUp': () => this.levels.next(this.scene.levels, 1),
      'PageDown': () => this.levels.next(this.scene.levels, -1),
      'n': () => byId('names').click(),
      'r': () => byId('rays').click(),
      'f': () => byId('follow').click(),
      'm': () => byId('move').click(),
      'a': () => byId('add').click(),
      'd': () => byId('measure').click(),
      'c': () => byId('drive').click(),
      'g': () => byId('send').click(),
      'l': () => byId('trails').click(),
      'w': () => byId('traffic').click(),
      'j': () => this.selectNext(1),
      'k': () => this.selectNext(-1),
      'p': () => this.takePicture(),
      'v': () => this.video.toggle(),
      '?': () => this.help.toggle(),
      '+': () => this.scene.zoomBy(1.25),
      '=': () => this.scene.zoomBy(1.25),
      '-': () => this.scene.zoomBy(0.8),
      'F2': () => byId('rename').click(),
      'Delete': () => byId('delete').click(),
      'Escape': () => {
        if (Popup.closeAny()) return;
        if (this.endCard.isOpen) return this.endCard.set(false);
        if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
        this.driving.set(false);
        this.editing.cancel();
      },
    };
    const arrows: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
    };
    window.addEventListener('keydown', event => {
      if (this.file?.press(event)) return event.preventDefault();
      if (event.defaultPrevented || isTyping(event) || isForControl(event)) return;
      if (this.editing.press(event)) return event.preventDefault();
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (this.driving.press(event)) return event.preventDefault();
      const [x, y] = arrows[event.key] ?? [0, 0];
      const tab = /^[1-4]$/.test(event.key) ? tabs[Number(event.key) - 1] : null;
      const action = x !== 0 || y !== 0 ? () => this.scene.moveByKeys(x, y, event.shiftKey)
        : tab ? () => this.showTab(tab) : actions[event.key];
      if (!action) return;
      event.preventDefault();
      action();
    });
  }

  private showTab(tab: Tab): void {
    const button = byId(`tab-${tab}`);
    if (button.offsetParent === null) {
      byId('robot-list').querySelector<HTMLElement>('.selected, button')?.focus();
      return;
    }
    button.focus();
    button.click();
  }
}

function isTyping({target}: KeyboardEvent): boolean {
  if (target instanceof HTMLInputElement) return !['range', 'checkbox', 'button'].includes(target.type);
  return target instanceof HTMLTextAreaElement;
}

// A key that the control with the focus uses itself. A button that was clicked has the focus too, but not its mark: there
// the keys are those of the page.
function isForControl({target, key}: KeyboardEvent): boolean {
  if (!(target instanceof HTMLElement) || target === document.body || target.id === 'scene') return false;
  const isMove = /^(Arrow|Page|Home|End)/.test(key);
  if (target instanceof HTMLInputElement && target.type === 'range') return isMove;
  if (!target.matches(':focus-visible')) return false;
  if (target instanceof HTMLSelectElement) return key !== 'Escape';  // letters choose
  return isMove || key === ' ' || key === 'Enter';
}

new Viewer();
