"use strict";
// Draws the plots of the page and links them: a selected moment is shown in all. The tables work without this script.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const ink = "#1b2430", soft = "#55606e", line = "#e3e7ec", blue = "#1f5fa8", orange = "#b8560b", grey = "#7a8694", red = "#b3261e";
  const font = "12px system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif";
  const element = id => document.getElementById(id);
  const plots = []; // {plot, height}: plots that follow the page's width
  const onTime = []; // plots over time

  const axis = (label, more) =>
    ({ label, labelFont: font, font, stroke: soft, labelSize: 22, grid: { stroke: line, width: 1 }, ticks: { stroke: line }, ...more });

  function absent(place, words) {
    place.textContent = words;
    place.className = "absent";
  }

  /// Draws a line for every event. If there are many, only some get a label, the harmful ones first.
  function drawEvents(u) {
    const ctx = u.ctx, { left, top, width, height } = u.bbox, ratio = width / u.over.clientWidth;
    ctx.save();
    ctx.font = `${11 * ratio}px sans-serif`;
    ctx.textAlign = "left";
    ctx.textBaseline = "bottom";
    const wrong = new Set(["perforation", "mistake"]);
    const taken = [[], [], []]; // occupied intervals in each of three rows of labels
    const weight = event => wrong.has(event.kind) ? 0 : event.kind === "step" ? 1 : 2;
    for (const event of [...data.events].sort((a, b) => weight(a) - weight(b) || a.t - b.t)) {
      const x = u.valToPos(event.t, "x", true);
      if (!(x >= left && x <= left + width)) continue;
      ctx.strokeStyle = ctx.fillStyle = wrong.has(event.kind) ? red : soft;
      ctx.setLineDash([3 * ratio, 3 * ratio]);
      ctx.beginPath();
      ctx.moveTo(x, top);
      ctx.lineTo(x, top + height);
      ctx.stroke();
      if (u !== onTime[0]) continue; // labels are drawn above the first plot only
      const full = event.what && event.kind === "step" ? event.what : event.kind;
      const words = full.length > 24 ? full.slice(0, 23) + "…" : full;
      const wide = ctx.measureText(words).width, start = Math.min(x + 3 * ratio, left + width - wide);
      const end = start + wide + 6 * ratio;
      const row = taken.findIndex(spans => spans.every(([a, b]) => end <= a || start >= b));
      if (row < 0) continue;
      ctx.fillText(words, start, top - (4 + 13 * row) * ratio);
      taken[row].push([start, end]);
    }
    ctx.restore();
  }

  function drawLimit(u) {
    if (!data.limit) return;
    const ctx = u.ctx, { left, top, width } = u.bbox, y = u.valToPos(data.limit, "y", true), ratio = width / u.over.clientWidth;
    if (y < top) return;
    ctx.save();
    ctx.strokeStyle = ctx.fillStyle = red;
    ctx.font = `${11 * ratio}px sans-serif`;
    ctx.textAlign = "right";
    ctx.textBaseline = "bottom";
    ctx.beginPath();
    ctx.moveTo(left, y);
    ctx.lineTo(left + width, y);
    ctx.stroke();
    ctx.fillText(`limit ${data.limit} N`, left + width - 4 * ratio, y - 2 * ratio);
    ctx.restore();
  }

  function add(id, options, values, height) {
    const place = element(id);
    const plot = new uPlot({ width: place.clientWidth, height, legend: { show: false }, ...options }, values, place);
    plots.push({ plot, place, height });
    return plot;
  }

  const clock = t => t < 60 ? `${t.toFixed(2)} s` : `${Math.floor(t / 60)}:${(t % 60).toFixed(2).padStart(5, "0")}`;
  const ticks = (u, values) => values.map(t => u.data[0][u.data[0].length - 1] < 60 ? String(t) : `${Math.floor(t / 60)}:${String(+(t % 60).toFixed(2)).padStart(2, "0")}`);

  // Shows the moment under the pointer, or of a table's button.
  const dots = [...document.querySelectorAll("circle.now")].map(dot =>
    ({ dot, points: dot.parentNode.querySelector("polyline").getAttribute("points").trim().split(" ").map(p => p.split(",")) }));
  function nearest(times, t) {
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < t) low = middle + 1; else high = middle;
    }
    return low;
  }
  function show(t) {
    const words = [clock(t)];
    for (const [name, unit] of [["speed", "mm/s"], ["force", "N"]])
      if (data[name] && data[name][0].length) {
        const value = data[name][1][nearest(data[name][0], t)];
        if (value !== null) words.push(`${name} ${value.toPrecision(3)} ${unit}`);
      }
    element("readout").textContent = words.join("  ·  ");
    if (!data.pathTimes) return;
    const i = nearest(data.pathTimes, t);
    for (const { dot, points } of dots) {
      if (!points[i]) continue;
      dot.setAttribute("cx", points[i][0]);
      dot.setAttribute("cy", points[i][1]);
      dot.style.display = "block";
    }
  }

  /// `others`: further series with their own times, drawn thinner behind `values`.
  function overTime(id, values, label, color, hooks, others = []) {
    if (!values || !values[0].length) return absent(element(id), `No ${id} was recorded.`);
    const first = onTime.length === 0, last = values[0][values[0].length - 1];
    const table = others.length ? uPlot.join([values, ...others]) : values;
    onTime.push(add(id, {
      padding: [first ? 44 : 8, 12, 0, 0],
      cursor: {
        sync: { key: "time", setSeries: false },
        drag: { x: true, y: false },
      },
      scales: { x: { time: false } },
      axes: [axis(first ? "" : `time [${last < 60 ? "s" : "min:s"}]`, { values: ticks, ...(first ? { labelSize: 4 } : {}) }), axis(label, { size: 58 })],
      series: [{}, { stroke: color, width: 1.2, fill: color + "18", points: { show: false } },
               ...others.map(() => ({ stroke: grey, width: 0.9, points: { show: false } }))],
      hooks: {
        draw: [u => { drawEvents(u); hooks.forEach(hook => hook(u)); }],
        setCursor: [u => { if (u.cursor.idx != null && u.cursor.left >= 0) show(u.posToVal(u.cursor.left, "x")); }],
        setScale: [(u, key) => { // all plots over time zoom together
          if (key !== "x") return;
          const { min, max } = u.scales.x;
          for (const other of onTime)
            if (other !== u && (other.scales.x.min !== min || other.scales.x.max !== max)) other.setScale("x", { min, max });
        }],
      },
    }, table, first ? 260 : 220));
  }

  overTime("speed", data.speed, "speed [mm/s]", blue, []);
  overTime("force", data.force, "force [N]", orange, [drawLimit], data.otherForces.filter(values => values[0].length));

  document.addEventListener("click", click => {
    const button = click.target.closest("button.moment");
    if (!button) return;
    const t = Number(button.dataset.t);
    const quick = matchMedia("(prefers-reduced-motion: reduce)").matches;
    element("time").scrollIntoView({ behavior: quick ? "auto" : "smooth" });
    for (const plot of onTime) {
      const { min, max } = plot.scales.x, data = plot.data[0];
      if (t < min || t > max) plot.setScale("x", { min: data[0], max: data[data.length - 1] });
    }
    setTimeout(() => { // after the plots have their new scale
      for (const plot of onTime) plot.setCursor({ left: plot.valToPos(t, "x"), top: plot.over.clientHeight / 2 }, false);
      show(t);
    });
  });

  if (element("histogram")) {
    if (data.histogram)
      add("histogram", {
        padding: [8, 12, 0, 0],
        cursor: { drag: { x: false, y: false }, points: { show: false } },
        legend: { show: true },
        scales: { x: { time: false, range: (u, low, high) => [0, high + data.histogram.width / 2] }, y: { range: (u, low, high) => [0, high * 1.08 || 1] } },
        axes: [axis("force [N]"), axis("time [s]", { size: 58 })],
        series: [{ label: "force", value: (u, v) => v == null ? "–" : `${+(v - data.histogram.width / 2).toPrecision(4)} to ${+(v + data.histogram.width / 2).toPrecision(4)} N` },
                 { label: "time", value: (u, v) => v == null ? "–" : `${v} s`, stroke: orange, fill: orange + "55", paths: uPlot.paths.bars({ size: [0.92, 80] }), points: { show: false } }],
        hooks: { draw: [u => {
          if (!data.limit || data.limit > u.scales.x.max) return;
          const x = u.valToPos(data.limit, "x", true), { top, height } = u.bbox;
          u.ctx.save();
          u.ctx.strokeStyle = red;
          u.ctx.beginPath();
          u.ctx.moveTo(x, top);
          u.ctx.lineTo(x, top + height);
          u.ctx.stroke();
          u.ctx.restore();
        }] },
      }, data.histogram.data, 200);
    else absent(element("histogram"), "The tool touched nothing, or no forces were recorded.");
  }

  const which = element("which");
  if (which) {
    let shown = null;
    const draw = () => {
      const curve = data.curves[which.selectedIndex];
      if (shown) {
        plots.splice(plots.indexOf(shown), 1);
        shown.plot.destroy();
      }
      const numbers = curve.values.map((_, i) => i + 1);
      const known = [...curve.values.filter(v => v !== null), ...("mean" in curve ? [curve.mean - curve.deviation, curve.mean + curve.deviation] : [])];
      const low = Math.min(...known), high = Math.max(...known), room = 0.12 * (high - low) || 0.1 * Math.abs(high) || 1;
      add("curve", {
        padding: [8, 12, 0, 0],
        cursor: { drag: { x: false, y: false } },
        legend: { show: true },
        scales: { x: { time: false, range: [0.7, numbers.length + 0.3] }, y: { range: [low - room, high + room] } },
        axes: [axis("session", { splits: () => numbers, values: u => numbers.map(n => u.width > 110 * numbers.length && data.dates[n - 1].slice(0, 10) || String(n)) }),
               axis(curve.unit ? `${curve.name} [${curve.unit}]` : curve.name, { size: 64 })],
        series: [{ label: "session", value: (u, v) => v == null ? "–" : data.dates[v - 1] || String(v) },
                 { label: curve.name, value: (u, v) => v == null ? "–" : `${v} ${curve.unit}`, stroke: blue, width: 2, spanGaps: true,
                   points: { show: true, size: 9, fill: blue } }],
        hooks: { drawClear: [u => {
          if (!("mean" in curve)) return;
          const { left, top, width, height } = u.bbox, at = v => u.valToPos(v, "y", true), ratio = width / u.over.clientWidth;
          u.ctx.save();
          u.ctx.beginPath();
          u.ctx.rect(left, top, width, height);
          u.ctx.clip();
          u.ctx.fillStyle = "#eceff3";
          u.ctx.fillRect(left, at(curve.mean + curve.deviation), width, at(curve.mean - curve.deviation) - at(curve.mean + curve.deviation));
          u.ctx.strokeStyle = u.ctx.fillStyle = soft;
          u.ctx.beginPath();
          u.ctx.moveTo(left, at(curve.mean));
          u.ctx.lineTo(left + width, at(curve.mean));
          u.ctx.stroke();
          u.ctx.font = `${11 * ratio}px sans-serif`;
          u.ctx.textAlign = "left";
          u.ctx.textBaseline = "bottom";
          u.ctx.fillText("others: mean ± deviation", left + 6 * ratio, at(curve.mean) - 2 * ratio);
          u.ctx.restore();
        }] },
      }, [numbers, curve.values], 240);
      shown = plots[plots.length - 1];
    };
    data.curves.forEach(curve => which.add(new Option(curve.name)));
    which.selectedIndex = Math.max(0, data.curves.findIndex(curve => curve.id === "path_length"));
    which.addEventListener("change", draw);
    draw();
  }

  const fit = width => plots.forEach(({ plot, place, height }) => plot.setSize({ width: width || place.clientWidth, height }));
  addEventListener("resize", () => fit());
  addEventListener("beforeprint", () => fit(680));
  addEventListener("afterprint", () => fit());
  document.documentElement.dataset.plots = String(plots.length); // for tests that check that they were drawn
})();
