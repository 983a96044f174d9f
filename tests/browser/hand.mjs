// Hand: mouse and keys as a person uses them. It adds up the time that a person takes, and waits for it if `pace` is 1; with
// 0 it acts at once. Times: pointing by Fitts' law (0.23 s, and 0.166 s for each bit), a press, a key, and a moment to find
// what is next, of the keystroke-level model of Card, Moran and Newell (1980).
const POINT = 0.23;  // s
const BIT = 0.166;  // s
const PRESS = 0.2;  // s, of a button, down and up
const KEY = 0.2;  // s, of an average typist
const FIND = 0.9;  // s, what to point at
const SCROLL = 0.6;  // s, of a list
const TARGET = 16;  // px

const sleep = seconds => new Promise(resolve => setTimeout(resolve, 1000 * seconds));

export class Hand {
  seconds = 0;
  at = {x: 640, y: 400};

  constructor(page, pace) {
    Object.assign(this, {page, pace});
  }

  async take(seconds) {
    this.seconds += seconds;
    if (this.pace > 0) await sleep(this.pace * seconds);
  }

  async moveTo(to) {
    const distance = Math.hypot(to.x - this.at.x, to.y - this.at.y);
    await this.take(POINT + BIT * Math.log2(distance / TARGET + 1));
    await this.page.mouse.move(to.x, to.y, {steps: this.pace > 0 ? 10 : 2});
    this.at = to;
  }

  async clickAt(to, modifier) {
    await this.take(FIND);
    await this.moveTo(to);
    if (modifier) await this.page.keyboard.down(modifier);
    await this.take(PRESS);
    await this.page.mouse.click(to.x, to.y);
    if (modifier) await this.page.keyboard.up(modifier);
  }

  // The middle of an element, which is scrolled into view.
  async placeOf(selector) {
    const element = this.page.locator(selector).first();
    await element.waitFor();
    const isInView = () => element.evaluate(each => {
      const box = each.getBoundingClientRect();
      const top = document.elementFromPoint(box.left + box.width / 2, box.top + box.height / 2);
      return each.contains(top);
    });
    if (!await isInView()) {
      await this.take(SCROLL);
      await element.scrollIntoViewIfNeeded();
    }
    const box = await element.boundingBox();
    return {x: box.x + box.width / 2, y: box.y + box.height / 2};
  }

  async click(selector) {
    await this.clickAt(await this.placeOf(selector));
  }

  async drag(from, to, modifier) {
    await this.take(FIND);
    await this.moveTo(from);
    if (modifier) await this.page.keyboard.down(modifier);
    await this.page.mouse.down();
    await this.take(PRESS / 2);
    await this.moveTo(to);
    await this.take(PRESS / 2);
    await this.page.mouse.up();
    if (modifier) await this.page.keyboard.up(modifier);
  }

  async press(key) {
    await this.take(KEY);
    await this.page.keyboard.press(key);
  }

  // Replaces the text of a field.
  async fill(selector, text) {
    await this.click(selector);
    await this.press('Control+a');
    await this.take(KEY * text.length);
    await this.page.keyboard.type(text);
    await this.press('Enter');
  }

  // A choice from a list. What the browser opens for it is no part of the page: its time alone counts.
  async choose(selector, value) {
    await this.take(FIND + PRESS);
    await this.moveTo(await this.placeOf(selector));
    await this.take(FIND + POINT + 2 * BIT + PRESS);
    await this.page.locator(selector).first().selectOption(value);
  }
}
