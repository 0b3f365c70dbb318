// The page works without this: charts are pictures, tables are tables. With uPlot they can be
// hovered and zoomed.
'use strict';
(function () {
  const study = JSON.parse(document.getElementById('study').textContent);

  for (const slider of document.querySelectorAll('.slider')) {
    const input = slider.querySelector('input');
    input.addEventListener('input', () => slider.style.setProperty('--at', input.value + '%'));
  }
  if (typeof uPlot === 'undefined') return;

  const colors = { ours: '#0072b2', source: '#d55e00', marching: '#888888', painting: '#009e73' };
  const smallest = 1e-9;  // errors below are drawn here
  const of = {
    color: 'worst error of a colour, |dC| / (' + study.white + ' + |C|)',
    T: 'worst error of the transmittance', L: 'worst error of the light added' };
  const kinds = { max: '', p99: ', exceeded by 1 %', rms: ', root mean square', mean: ', mean' };

  const time = s => {
    const [k, u] = s >= 1 ? [1, 's'] : s >= 1e-3 ? [1e3, 'ms'] : s >= 1e-6 ? [1e6, 'µs'] : [1e9, 'ns'];
    return +(s * k).toPrecision(3) + ' ' + u;
  };
  const pixels = study.width * study.height;

  function chart(holder, subject, what, kind) {
    const curves = [];
    for (const method of subject.methods) {
      const points = method.points.filter(p => p.seconds > 0 && p[what][kind] !== null);
      if (points.length) curves.push({ method, points });
    }
    // One column of times for all; each method has values in its own places, in their order along the knob.
    const xs = [...new Set(curves.flatMap(c => c.points.map(p => p.seconds)))].sort((a, b) => a - b);
    const data = [xs], at = [null];
    for (const c of curves) {
      const ys = xs.map(() => null), places = xs.map(() => null);
      for (const p of c.points) {
        const i = xs.indexOf(p.seconds);
        ys[i] = Math.max(p[what][kind], smallest);
        places[i] = p;
      }
      data.push(ys);
      at.push(places);
    }
    const all = data.slice(1).flat().filter(v => v !== null);
    // All of the data: whole decades. Less: what a hand has drawn.
    const range = values => {
      const least = Math.min(...values), most = Math.max(...values);
      const a = Math.floor(Math.log10(least)), b = Math.ceil(Math.log10(most));
      const whole = [10 ** a, 10 ** Math.max(b, a + 1)];
      return (u, lo, hi) => lo < hi && (lo !== least || hi !== most) ? [lo, hi] : whole;
    };
    const tip = document.createElement('div');
    tip.className = 'tip';

    // Quartiles of the time, as bars.
    const noise = u => {
      const ctx = u.ctx;
      ctx.save();
      ctx.beginPath();
      ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
      ctx.clip();
      curves.forEach((c, k) => {
        if (!u.series[k + 1].show) return;
        ctx.strokeStyle = colors[c.method.kind];
        ctx.lineWidth = 2 * devicePixelRatio;
        for (const p of c.points) {
          const y = u.valToPos(Math.max(p[what][kind], smallest), 'y', true);
          const x = q => u.valToPos(p.frame_seconds + 1e-9 * q * pixels, 'x', true);
          ctx.beginPath();
          ctx.moveTo(x(p.ns_per_pixel.q1), y);
          ctx.lineTo(x(p.ns_per_pixel.q3), y);
          ctx.stroke();
        }
      });
      ctx.restore();
    };
    const hover = u => {
      const { left, top } = u.cursor;
      let best = null, near = 40 * 40;
      if (left >= 0) curves.forEach((c, k) => {
        if (!u.series[k + 1].show) return;
        xs.forEach((x, i) => {
          if (data[k + 1][i] === null) return;
          const dx = u.valToPos(x, 'x') - left, dy = u.valToPos(data[k + 1][i], 'y') - top;
          if (dx * dx + dy * dy < near) near = dx * dx + dy * dy, best = [c, at[k + 1][i], data[k + 1][i], x];
        });
      });
      tip.style.display = best ? 'block' : 'none';
      if (!best) return;
      const [c, p, y, x] = best;
      tip.textContent = c.method.name + ': ' + p.setting + '\n' + time(p.seconds) + ' for the frame, ' +
        time(1e-9 * p.ns_per_pixel.median) + ' a pixel\nerror ' + p[what][kind].toPrecision(2) +
        ', worst at pixel ' + p.worst_pixel.join(', ');
      tip.style.left = Math.min(u.valToPos(x, 'x') + 14, u.over.clientWidth - 240) + 'px';
      tip.style.top = u.valToPos(y, 'y') + 14 + 'px';
    };
    const grid = { stroke: '#dde', width: 1 };
    const plot = new uPlot({
      width: Math.min(holder.clientWidth || 900, 1020), height: 460,
      scales: {
        x: { distr: 3, time: false, range: range(xs) },
        y: { distr: 3, range: range(all) } },
      series: [{ label: 'time', value: (u, v) => v === null ? '' : time(v) }].concat(curves.map(c => ({
        label: c.method.name, stroke: colors[c.method.kind], width: 2, spanGaps: true,
        points: { show: true, size: 9, fill: colors[c.method.kind] },
        value: (u, v) => v === null ? '' : v.toPrecision(2) }))),
      axes: [
        { label: 'time for the ' + study.width + ' x ' + study.height + ' frame, one core', grid,
          values: (u, vs) => vs.map(v => v !== null && Number.isInteger(+Math.log10(v).toFixed(6)) ? time(v) : '') },
        { label: of[what] + kinds[kind], grid, size: 70,
          values: (u, vs) => vs.map(v => v !== null && Number.isInteger(+Math.log10(v).toFixed(6)) ? '1e' + Math.round(Math.log10(v)) : '') }],
      cursor: { drag: { x: true, y: true, uni: 20 } },
      hooks: { draw: [noise], setCursor: [hover], ready: [u => { u.over.appendChild(tip); }] }
    }, data, holder);
    return plot;
  }

  for (const place of document.querySelectorAll('.chart')) {
    const subject = study.subjects[+place.dataset.subject];
    place.querySelector('svg').remove();
    const choose = document.createElement('label');
    choose.textContent = 'error of ';
    const select = (options) => {
      const s = document.createElement('select');
      for (const [value, text] of Object.entries(options)) s.add(new Option(text, value));
      return s;
    };
    const what = select({ color: 'the colour', T: 'the transmittance T', L: 'the light L' });
    const kind = select({ max: 'worst', p99: '99 %', rms: 'rms', mean: 'mean' });
    const help = document.createElement('span');
    help.textContent = '  drag to zoom, double click to see all, click a name to hide it';
    choose.append(what, ' ', kind, help);
    const holder = document.createElement('div');
    place.append(choose, holder);
    let plot = chart(holder, subject, 'color', 'max');
    const again = () => {
      plot.destroy();
      plot = chart(holder, subject, what.value, kind.value);
    };
    what.addEventListener('change', again);
    kind.addEventListener('change', again);
  }
  document.documentElement.dataset.charts = 'uplot';
})();
