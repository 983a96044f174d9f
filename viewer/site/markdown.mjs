// Markdown as HTML, with the anchors of headings that links in the documents name, and the sections for the search.
import {createRequire} from 'node:module';

const {Marked} = createRequire(new URL('../web/package.json', import.meta.url))('marked');

export const escape = text => text.replace(/[&<>"]/g, letter => ({'&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;'})[letter]);

export const plain = html => html.replace(/<[^>]*>/g, '').replace(/&(amp|lt|gt|quot|#39);/g, (_, name) => (
  {amp: '&', lt: '<', gt: '>', quot: '"', '#39': "'"})[name]);

// As the hosts of repositories make them; a second heading of a name has a number.
class Anchors {
  constructor() {
    this.counts = new Map();
  }
  of(heading) {
    const base = heading.toLowerCase().replace(/[^\p{L}\p{N}_\- ]/gu, '').trim().replaceAll(' ', '-');
    const count = this.counts.get(base) ?? 0;
    this.counts.set(base, count + 1);
    return count === 0 ? base : `${base}-${count}`;
  }
}

// {html, title, sections: [{anchor, title, level, text}]}. `link`: the address of a target as the page names it.
export function render(text, link) {
  const anchors = new Anchors();
  const sections = [{anchor: '', title: '', level: 1, text: ''}];
  const note = more => {
    sections.at(-1).text += ` ${more}`;
    return '';
  };
  const marked = new Marked({
    gfm: true,
    renderer: {
      heading({tokens, depth}) {
        const html = this.parser.parseInline(tokens);
        const title = plain(html);
        const anchor = anchors.of(title);
        if (depth === 1 && sections[0].title === '') Object.assign(sections[0], {anchor: '', title});
        else sections.push({anchor, title, level: depth, text: ''});
        const mark = depth === 1 ? '' : `<a class="anchor" href="#${anchor}" aria-label="Link to ${escape(title)}">#</a>`;
        return `<h${depth} id="${anchor}">${html}${mark}</h${depth}>\n`;
      },
      link({href, title, tokens}) {
        const html = this.parser.parseInline(tokens);
        return `<a href="${escape(link(href))}"${title ? ` title="${escape(title)}"` : ''}>${html}</a>`;
      },
      image({href, text: label}) {
        note(label);
        return `<img src="${escape(link(href))}" alt="${escape(label)}" loading="lazy">`;
      },
      code({text: code, lang}) {
        note(code);
        return `<div class="code"><pre tabindex="0"><code${lang ? ` class="lang-${escape(lang)}"` : ''}>${escape(code)}\n</code></pre></div>\n`;
      },
      table(token) {
        const row = (cells, tag) => `<tr>${cells.map((cell, i) => {
          const align = token.align[i] ? ` style="text-align:${token.align[i]}"` : '';
          return `<${tag}${align}>${this.parser.parseInline(cell.tokens)}</${tag}>`;
        }).join('')}</tr>`;
        for (const cells of [token.header, ...token.rows]) note(cells.map(cell => cell.text).join(' '));
        // Tables of pictures have no texts in their first row.
        const empty = token.header.every(cell => cell.text === '');
        const head = empty ? '' : `<thead>${row(token.header, 'th')}</thead>`;
        return `<div class="table" tabindex="0" role="region" aria-label="Table"><table>${head}<tbody>${token.rows.map(cells => row(cells, 'td')).join('\n')}</tbody></table></div>\n`;
      },
      paragraph({tokens}) {
        const html = this.parser.parseInline(tokens);
        note(plain(html));
        return `<p>${html}</p>\n`;
      },
      listitem(item) {
        note(plain(this.parser.parse(item.tokens.filter(token => token.type === 'text'))));
        return `<li>${this.parser.parse(item.tokens, !!item.loose)}</li>\n`;
      },
    },
  });
  const html = marked.parse(text);
  for (const section of sections) section.text = section.text.replace(/\s+/g, ' ').trim();
  return {html, title: sections[0].title, sections};
}
