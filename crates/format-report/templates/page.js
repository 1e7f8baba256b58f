'use strict';
(() => {
  const root = document.documentElement;
  const all = (selector, from = document) => [...from.querySelectorAll(selector)];

  // Dark and light: the system's, until someone chooses.
  document.getElementById('theme').addEventListener('click', () => {
    const dark = root.dataset.theme ? root.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
    root.dataset.theme = dark ? 'light' : 'dark';
  });

  // Formats on and off, in all pictures at once.
  const show = box => all('.run' + box.dataset.run).forEach(part => part.classList.toggle('off', !box.checked));
  const boxes = all('#switches input');
  boxes.forEach(box => { show(box); box.addEventListener('change', () => show(box)); });
  all('#switches button').forEach(button => button.addEventListener('click', () =>
    boxes.forEach(box => { box.checked = button.dataset.all === '1'; show(box); })));

  // One format at a time, the same in all such chapters.
  const choices = all('.choice select');
  const choose = run => {
    choices.forEach(choice => { choice.value = run; });
    all('figure[data-of-run]').forEach(figure => { figure.hidden = figure.dataset.ofRun !== run; });
  };
  choices.forEach(choice => choice.addEventListener('change', () => choose(choice.value)));
  if (choices.length) choose(choices[0].value);

  // Values under the pointer. A picture says where its frame is and what its axes run over.
  const tip = document.getElementById('tip');
  const number = value => {
    if (value === 0) return '0';
    const size = Math.abs(value);
    return size < 1e-3 || size >= 1e6 ? value.toExponential(1) : String(Number(value.toPrecision(3)));
  };
  const value = (axis, share) => {
    const at = axis.from + share * (axis.to - axis.from);
    return axis.log ? 10 ** at : at;
  };
  const axis = ([from, to, log]) => ({ from, to, log: log === 1 });
  const points = new WeakMap();
  const pointsOf = path => {
    if (!points.has(path)) {
      const numbers = path.getAttribute('d').slice(1).split(/[L ]/).map(Number);
      const list = [];
      for (let i = 0; i + 1 < numbers.length; i += 2) list.push([numbers[i], numbers[i + 1]]);
      points.set(path, list);
    }
    return points.get(path);
  };
  const nearest = (list, x) => {
    let low = 0, high = list.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (list[middle][0] < x) low = middle; else high = middle;
    }
    return Math.abs(list[low][0] - x) <= Math.abs(list[high][0] - x) ? list[low] : list[high];
  };
  const place = event => {
    tip.hidden = false;
    const { width, height } = tip.getBoundingClientRect();
    tip.style.left = Math.max(4, Math.min(event.clientX + 14, innerWidth - width - 8)) + 'px';
    tip.style.top = (event.clientY + 18 + height > innerHeight ? event.clientY - height - 12 : event.clientY + 18) + 'px';
  };
  all('svg[data-x]').forEach(svg => {
    const frame = svg.dataset.x.split(' ').map(Number);
    const [left, right, top, bottom] = frame;
    const across = axis(frame.slice(4)), up = axis(svg.dataset.y.split(' ').map(Number));
    const cross = document.createElementNS('http://www.w3.org/2000/svg', 'path');
    cross.setAttribute('class', 'cross');
    svg.append(cross);
    const label = (all('.label:not([transform])', svg)[0] || { textContent: '' }).textContent.trim();
    svg.addEventListener('pointermove', event => {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      const lines = at.x < left || at.x > right ? [] : all('g[data-name]:not(.off)', svg).flatMap(group => {
        const path = group.querySelector('.line');
        if (!path) return [];
        const found = nearest(pointsOf(path), at.x);
        return [[group.dataset.name, value(up, (bottom - found[1]) / (bottom - top))]];
      });
      if (!lines.length) { tip.hidden = true; cross.removeAttribute('d'); return; }
      cross.setAttribute('d', `M${at.x} ${top}V${bottom}`);
      const wide = Math.max(...lines.map(([name]) => name.length));
      tip.textContent = [label + ': ' + number(value(across, (at.x - left) / (right - left))),
        ...lines.map(([name, y]) => name.padEnd(wide + 2) + number(y))].join('\n');
      place(event);
    });
    svg.addEventListener('pointerleave', () => { tip.hidden = true; cross.removeAttribute('d'); });
  });
  // Where a part of a picture has a title of its own, that is shown at once instead of after the browser's delay.
  all('figure svg:not([data-x])').forEach(svg => {
    svg.addEventListener('pointermove', event => {
      const title = event.target !== svg && event.target.querySelector && event.target.querySelector(':scope > title');
      if (!title) { tip.hidden = true; return; }
      tip.textContent = title.textContent.trim();
      place(event);
    });
    svg.addEventListener('pointerleave', () => { tip.hidden = true; });
  });

  // The recommended row of the table.
  const answer = all('.switch.recommended')[0];
  const chosen = answer ? answer.textContent.trim() : '';
  all('#table tbody tr').forEach(row => {
    const [format, , path] = all('td', row).map(cell => cell.textContent);
    row.classList.toggle('chosen', `${format} ${path}` === chosen);
  });
})();
