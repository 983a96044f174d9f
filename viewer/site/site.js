// Of all pages: the theme, the contents on a phone, the search, and the demo in the start page.
'use strict';

(() => {
  const byId = id => document.getElementById(id);
  const base = document.body.dataset.base;

  byId('theme').onclick = () => {
    const next = document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark';
    document.documentElement.dataset.theme = next;
    try {
      localStorage.setItem('theme', next);
    } catch {
      // nothing is kept
    }
  };

  const menu = byId('menu');
  const setMenu = open => {
    document.body.classList.toggle('menu', open);
    menu.setAttribute('aria-expanded', String(open));
  };
  menu.onclick = () => setMenu(!document.body.classList.contains('menu'));

  // The demo takes the place of its picture. A phone opens it as a page of its own.
  const run = byId('run-here');
  if (run) {
    run.onclick = event => {
      if (innerWidth < 700 || event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      const figure = run.closest('figure');
      const frame = document.createElement('iframe');
      frame.src = figure.dataset.live;
      frame.title = 'The demo, simulated in this page';
      figure.querySelector('img').replaceWith(frame);
      const whole = document.createElement('a');
      Object.assign(whole, {className: 'button', href: run.href, textContent: 'Open it as a page'});
      run.replaceWith(whole);
    };
  }

  // Commands are copied by a button.
  for (const block of document.querySelectorAll('.code')) {
    if (!navigator.clipboard) break;
    const button = document.createElement('button');
    button.className = 'copy';
    button.textContent = 'Copy';
    button.onclick = async () => {
      await navigator.clipboard.writeText(block.querySelector('code').textContent);
      button.textContent = 'Copied';
      setTimeout(() => { button.textContent = 'Copy'; }, 1500);
    };
    block.append(button);
  }

  // Search ---------------------------------------------------------------------------------------------------------
  const MOST = 12;  // results
  const input = byId('search');
  const list = byId('found');
  let chosen = -1;
  let loading = null;

  // The index is loaded when it is first needed.
  function load() {
    loading ??= new Promise(resolve => {
      const script = document.createElement('script');
      script.src = `${base}/search_index.js`;
      script.onload = () => resolve(window.searchIndex.flatMap(([path, page, sections]) => sections.map(([anchor, title, text]) => (
        {path, page, anchor, title, text, inPage: page.toLowerCase(), inTitle: title.toLowerCase(), inText: text.toLowerCase()}))));
      document.head.append(script);
    });
    return loading;
  }

  // Each word must be somewhere; in titles, and at the beginning of words, it counts more.
  function score(section, words) {
    let sum = 0;
    for (const word of words) {
      const beginsIn = text => new RegExp(`(^|[^\\p{L}\\p{N}_])${word.replace(/[.*+?^${}()|[\]\\]/g, '\\$&')}`, 'u').test(text);
      let best = 0;
      if (section.inText.includes(word)) best = beginsIn(section.inText) ? 2 : 1;
      if (section.inPage.includes(word)) best = beginsIn(section.inPage) ? 5 : Math.max(best, 2);
      if (section.inTitle.includes(word)) best = section.inTitle === word ? 20 : beginsIn(section.inTitle) ? 9 : Math.max(best, 3);
      if (best === 0) return 0;
      sum += best;
    }
    return sum + 1 / (1 + section.title.length);
  }

  // The text around the first word that is in it, with the words marked.
  function excerpt(section, words) {
    const at = Math.min(...words.map(word => section.inText.indexOf(word)).filter(place => place >= 0), Infinity);
    let from = Number.isFinite(at) ? Math.max(0, at - 50) : 0;
    if (from > 0) from = section.text.indexOf(' ', from) + 1;
    const end = section.text.lastIndexOf(' ', from + 150);
    const line = document.createElement('span');
    line.className = 'excerpt';
    const isWhole = section.text.length <= from + 150;
    const text = (from > 0 ? '… ' : '') + section.text.slice(from, isWhole || end <= from ? from + 150 : end) + (isWhole ? '' : ' …');
    const pattern = new RegExp(`(${words.map(word => word.replace(/[.*+?^${}()|[\]\\]/g, '\\$&')).join('|')})`, 'giu');
    for (const part of text.split(pattern)) {
      const node = words.includes(part.toLowerCase()) ? document.createElement('mark') : document.createElement('span');
      node.textContent = part;
      line.append(node);
    }
    return line;
  }

  function choose(next) {
    const rows = [...list.children];
    if (rows.length === 0) return;
    chosen = (next + rows.length) % rows.length;
    rows.forEach((row, i) => row.setAttribute('aria-selected', String(i === chosen)));
    rows[chosen].scrollIntoView({block: 'nearest'});
    input.setAttribute('aria-activedescendant', rows[chosen].id);
  }

  async function search() {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    if (words.length === 0) return show(false);
    const sections = await load();
    const found = sections.map(section => [score(section, words), section]).filter(([value]) => value > 0);
    found.sort((a, b) => b[0] - a[0]);
    list.replaceChildren(...found.slice(0, MOST).map(([, section], i) => {
      const row = document.createElement('li');
      row.id = `found-${i}`;
      row.setAttribute('role', 'option');
      row.dataset.href = `${base}/${section.path}${section.anchor ? `#${section.anchor}` : ''}`;
      const title = document.createElement('strong');
      title.textContent = section.title;
      const place = document.createElement('span');
      place.className = 'place';
      place.textContent = section.anchor ? section.page : '';
      row.append(title, place, excerpt(section, words));
      row.onclick = () => go(row);
      return row;
    }));
    if (found.length === 0) {
      const none = document.createElement('li');
      none.setAttribute('role', 'option');
      none.setAttribute('aria-disabled', 'true');
      none.textContent = `Nothing has “${input.value.trim()}”.`;
      list.append(none);
    }
    chosen = -1;
    show(true);
  }

  function go(row) {
    if (row?.dataset.href) location.href = row.dataset.href;
    show(false);
  }

  function show(open) {
    list.hidden = !open;
    input.setAttribute('aria-expanded', String(open));
    if (!open) input.removeAttribute('aria-activedescendant');
  }

  input.onfocus = () => void load();
  input.oninput = () => void search();
  input.onkeydown = event => {
    if (event.key === 'ArrowDown') choose(chosen + 1);
    else if (event.key === 'ArrowUp') choose(chosen - 1);
    else if (event.key === 'Enter') go(list.children[Math.max(chosen, 0)]);
    else if (event.key === 'Escape') show(false);
    else return;
    event.preventDefault();
  };
  document.addEventListener('click', event => {
    if (!event.target.closest('[role=search]')) show(false);
    if (event.target.closest('main')) setMenu(false);
  });
  document.addEventListener('keydown', event => {
    if (event.key === '/' && !/^(INPUT|TEXTAREA)$/.test(event.target.tagName)) {
      event.preventDefault();
      input.focus();
    }
    if (event.key === 'Escape') setMenu(false);
  });
})();
