"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const number = (v) => (v === "inf" ? Infinity : v);
  const objects = (fields, rows) => rows.map((row) => Object.fromEntries(fields.map((f, i) => [f, number(row[i])])));
  const cells = new Map(data.cells.map((c) => [c.id, c]));
  const families = new Map(data.families.map((f) => [f.id, f]));
  const rows = objects(data.fields, data.rows);
  const curves = objects(data.curveFields, data.curves);
  const shapes = data.shapes.map((path) => new Path2D(path));
  if (rows.length === 0) return;

  // ---- numbers as text
  const percent = (x) => `${Number((100 * x).toPrecision(3))}\u00a0%`;
  const trimmed = (x) => String(Number(x.toPrecision(3)));
  const short = (x) => (x == null ? "—" : x === Infinity ? "∞" : x !== 0 && (x < 1e-3 || x >= 1e5) ? x.toExponential(1) : trimmed(x));
  const nanoseconds = (x) => {
    if (x == null) return "—";
    for (const [limit, scale, unit] of [[1e3, 1, "ns"], [1e6, 1e3, "µs"], [1e9, 1e6, "ms"]]) {
      if (x < limit * 0.9995) return `${trimmed(x / scale)} ${unit}`;
    }
    return `${trimmed(x / 1e9)} s`;
  };
  const power = (k) => (k >= -2 && k <= 3 ? String(Number((10 ** k).toPrecision(1))) : `1e${k}`);

  // ---- what is selected
  const boxes = (kind) => [...document.querySelectorAll(`fieldset[data-kind="${kind}"] input`)];
  const chosen = (kind) => new Set(boxes(kind).filter((b) => b.checked).map((b) => b.value));
  const selection = () => ({
    surface: boxes("surface").length ? chosen("surface") : null,
    family: chosen("family"), variant: chosen("variant"), formulation: chosen("formulation"),
  });
  const isCellShown = (cell, now) =>
    (!now.surface || now.surface.has(cell.surface)) && now.variant.has(cell.variant) && now.formulation.has(cell.formulation);
  const isShown = (row, now) => isCellShown(cells.get(row.cell), now) && now.family.has(families.get(row.family).name);
  const grouped = (list) => {
    const groups = new Map();
    for (const row of list) groups.set(row.family, [...(groups.get(row.family) ?? []), row]);
    return [...groups].sort((a, b) => a[0] - b[0]);
  };

  // ---- drawing: markers, whiskers, bands of zero and infinity
  const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const theme = () => ({ ink: css("--ink"), soft: css("--soft"), line: css("--line"), paper: css("--raised"), tint: css("--tint") });

  function drawMarker(context, look, x, y, size, colours) {
    const outline = shapes[look.shape];
    context.save();
    context.translate(x, y);
    context.scale(size, size);
    context.fillStyle = look.fill === "full" ? look.colour : colours.paper;
    context.fill(outline);
    if (look.fill === "left" || look.fill === "bottom") {
      context.save();
      context.clip(outline);
      context.fillStyle = look.colour;
      if (look.fill === "left") context.fillRect(-2, -2, 2, 4);
      else context.fillRect(-2, 0, 4, 2);
      context.restore();
    }
    context.lineWidth = 1.6 / size;
    context.strokeStyle = look.colour;
    context.stroke(outline);
    context.restore();
  }

  const bandPlugin = {
    id: "bands",
    beforeDatasetsDraw(chart) {
      const { ctx, chartArea: area, scales, options } = chart;
      const settings = options.graze;
      ctx.save();
      ctx.fillStyle = settings.colours.tint;
      for (const at of settings.bands) {
        const middle = scales.y.getPixelForValue(at);
        ctx.fillRect(area.left, middle - 10, area.right - area.left, 20);
      }
      ctx.restore();
    },
    afterDatasetsDraw(chart) {
      const { ctx, options, scales } = chart;
      const { colours } = options.graze;
      const active = new Set(chart.getActiveElements().map((e) => `${e.datasetIndex}/${e.index}`));
      chart.data.datasets.forEach((set, s) => {
        chart.getDatasetMeta(s).data.forEach((element, i) => {
          const point = set.data[i];
          if (!point.look || point.unmarked || (set.markEvery && i % set.markEvery !== set.markAt)) return;
          const size = (active.has(`${s}/${i}`) ? 1.5 : 1) * (set.markSize ?? 5);
          if (point.whisker) {
            ctx.save();
            ctx.strokeStyle = point.look.colour;
            ctx.lineWidth = 1.5;
            ctx.beginPath();
            ctx.moveTo(scales.x.getPixelForValue(point.whisker[0]), element.y);
            ctx.lineTo(scales.x.getPixelForValue(point.whisker[1]), element.y);
            ctx.stroke();
            ctx.restore();
          }
          drawMarker(ctx, point.look, element.x, element.y, size, colours);
          if (point.sign) {
            ctx.save();
            ctx.fillStyle = colours.ink;
            ctx.font = "11px system-ui, sans-serif";
            ctx.fillText(point.sign, element.x + 5, element.y - 5);
            ctx.restore();
          }
        });
      });
    },
  };

  // Axes hold log10 of the value; ticks stand at decades, or at 1, 2, 5 on short axes.
  function logTicks(low, high) {
    const ticks = [];
    const first = Math.ceil(low - 1e-9), last = Math.floor(high + 1e-9);
    const step = Math.max(1, Math.ceil((last - first) / 6));
    for (let k = Math.floor(low); k <= last; ++k) {
      if ((k - first) % step === 0 && k >= low - 1e-9) ticks.push(k);
      if (high - low < 2.2) for (const m of [2, 5]) if (k + Math.log10(m) >= low && k + Math.log10(m) <= high) ticks.push(k + Math.log10(m));
    }
    return ticks.sort((a, b) => a - b);
  }

  function logAxis(title, low, high, text, extra = []) {
    const marks = [...logTicks(low, high).map((v) => ({ value: v, label: text(10 ** v, v) })), ...extra].sort((a, b) => a.value - b.value);
    const ends = marks.map((m) => m.value);
    return {
      type: "linear", min: Math.min(low, ...ends) - (extra.length ? 0.25 : 0), max: Math.max(high, ...ends) + (extra.length ? 0.25 : 0),
      title: { display: true, text: title },
      afterBuildTicks: (axis) => { axis.ticks = marks.map((m) => ({ ...m })); },
      ticks: { callback: (value) => marks.find((m) => m.value === value)?.label ?? "", autoSkipPadding: 8, maxRotation: 0 },
    };
  }

  const charts = new Map();
  function clearPanels(id) {
    for (const chart of charts.get(id) ?? []) chart.destroy();
    charts.set(id, []);
    const box = document.getElementById(id);
    if (box) box.replaceChildren();
    return box;
  }

  function addPanel(id, box, title, description, foot, config) {
    const panel = document.createElement("figure");
    panel.className = "panel";
    const head = document.createElement("h3");
    head.textContent = title;
    const frame = document.createElement("div");
    frame.className = "canvas";
    const canvas = document.createElement("canvas");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", description);
    frame.append(canvas);
    panel.append(head, frame);
    if (foot) {
      const line = document.createElement("p");
      line.textContent = foot;
      panel.append(line);
    }
    box.append(panel);
    const colours = theme();
    for (const axis of Object.values(config.options.scales)) {
      axis.grid = { color: colours.line, drawBorder: false };
      axis.ticks = { ...axis.ticks, color: colours.soft, font: { size: 11 } };
      axis.title = { ...axis.title, color: colours.soft, font: { size: 11 } };
    }
    Object.assign(config.options, {
      responsive: true, maintainAspectRatio: false, animation: false, parsing: false, normalized: true,
      layout: { padding: { top: 6, right: 10 } },
      graze: { colours, bands: config.bands ?? [] },
    });
    config.options.plugins = {
      legend: { display: false },
      tooltip: { displayColors: false, callbacks: config.callbacks, titleFont: { size: 12 }, bodyFont: { size: 11.5 }, padding: 8 },
    };
    charts.get(id).push(new Chart(canvas, { type: "scatter", data: config.data, options: config.options, plugins: [bandPlugin] }));
  }

  function nothing(box) {
    const line = document.createElement("p");
    line.textContent = "Nothing is selected, or nothing selected has this measure.";
    box.append(line);
  }

  // ---- figure 1
  const metricNames = { condition_units: "condition units", ulps: "ulps of l", backward: "backward error, ulps", normal_error: "angle of the normal, radians" };
  const errorMetrics = new Map([
    ["wrong_share", "Share of wrong rays"], ["inexcusable_share", "Share of wrong rays, ambiguous ones apart"],
    ["wrong_first_share", "Share of rays with a wrong first hit"], ["unsolved_share", "Share of unsolved rays"],
    ...Object.entries(metricNames).flatMap(([m, name]) => [
      [`${m}_p50`, `Median error, ${name}`], [`${m}_p99`, `99th percentile of the error, ${name}`], [`${m}_worst`, `Worst error, ${name}`]]),
  ]);
  const costMetrics = new Map([["ns_median", "time a ray"], ["evaluations_per_ray", "evaluations a ray"]]);
  const hasData = (name) => rows.some((r) => r[name] != null);

  function fillSelect(id, options) {
    const select = document.getElementById(id);
    if (!select) return null;
    for (const [value, text] of options) select.add(new Option(text, value));
    return select;
  }
  const errorSelect = fillSelect("error-metric", [...errorMetrics].filter(([name]) => hasData(name)));
  const costSelect = fillSelect("cost-metric", [...costMetrics].filter(([name]) => hasData(name)));
  const curveMetrics = new Map([
    ["wrong_share", "Share of wrong rays"], ["inexcusable_share", "Share of wrong rays, ambiguous ones apart"], ["unsolved_share", "Share of unsolved rays"],
    ["condition_units_p50", "Median error, condition units"], ["condition_units_p99", "99th percentile of the error, condition units"]]);
  const curveSelect = fillSelect("curve-metric", curveMetrics);
  const cdfSelect = fillSelect("cdf-metric", Object.entries(metricNames).filter(([m]) => data.bins.some((b) => b[2] === m)));

  // Zero and infinity get a band of their own, 0.7 decades beyond the finite values.
  function bandedAxis(values, isShare, title, rays) {
    const finite = values.filter((v) => v > 0 && v < Infinity).map(Math.log10);
    if (isShare) finite.push(Math.log10(Math.min(1, 3 / rays)));
    if (finite.length === 0) finite.push(0);
    const high = isShare ? 0 : Math.max(...finite), low = Math.min(...finite, high - 1);
    const extra = [], bands = [];
    const zero = low - 0.7, infinite = high + 0.7;
    if (values.includes(0)) { extra.push({ value: zero, label: isShare ? "none" : "0" }); bands.push(zero); }
    if (values.includes(Infinity)) { extra.push({ value: infinite, label: "∞" }); bands.push(infinite); }
    const text = (v, k) => (isShare ? percent(v) : Number.isInteger(k) ? power(k) : short(v));
    const axis = logAxis(title, Math.max(low, -320), high, text, extra);
    if (!extra.length) { axis.min -= 0.2; axis.max += 0.15; }
    return { axis, bands, place: (v) => (v === 0 ? zero : v === Infinity ? infinite : Math.log10(v)) };
  }

  function paretoFront(points) {
    const front = [];
    for (const p of [...points].sort((a, b) => a.cost - b.cost || a.error - b.error)) {
      if (!front.length || p.error < front.at(-1).error) front.push(p);
    }
    return front;
  }

  const sign = (row, isTime) => (isTime && row.censored ? "≥" : "") + (row.wrong > 0 ? "×" : row.unsolved > 0 ? "?" : "");
  const share = (k, n) => (k ? `${percent(k / n)} (${k} of ${n})` : `none of ${n}, below ${percent(Math.min(1, 3 / n))}`);
  function describe(row) {
    const lines = [`wrong: ${share(row.wrong, row.rays)}${row.ambiguous_wrong ? `, ${row.ambiguous_wrong} ambiguous` : ""}`];
    lines.push(`missed ${row.missed}, spurious ${row.spurious}, wrong first ${row.wrong_first}`);
    lines.push(`uncertain ${row.uncertain}, failed ${row.failed}`);
    lines.push(`error, c.u.: median ${short(row.condition_units_p50)}, p99 ${short(row.condition_units_p99)}`);
    lines.push(`worst error, c.u.: ${short(row.condition_units_worst)}`);
    if (row.ns_median != null) {
      lines.push(`${row.censored ? "at least " : ""}${nanoseconds(row.ns_median)} a ray, ${nanoseconds(row.ns_min)} to ${nanoseconds(row.ns_p90)}`);
      lines.push(`${row.repeats} repeats, query ${row.query}`);
    }
    lines.push(`${short(row.evaluations_per_ray)} evaluations a ray`);
    return lines;
  }

  function drawErrorTime(now) {
    const id = "error-time-panels", box = clearPanels(id);
    const metric = errorSelect.value, cost = costSelect.value, isTime = cost === "ns_median", isShare = metric.endsWith("_share");
    const shown = rows.filter((r) => isShown(r, now) && r[cost] != null && r[metric] != null);
    if (shown.length === 0) nothing(box);
    for (const [family, list] of grouped(shown)) {
      const rays = Math.max(...list.map((r) => r.rays));
      const { axis: y, bands, place } = bandedAxis(list.map((r) => r[metric]), isShare, isShare ? "" : "error", rays);
      const costs = list.flatMap((r) => (isTime ? [r.ns_min, r.ns_p90, r.ns_median] : [Math.max(r[cost], 0.1)])).map(Math.log10);
      const x = logAxis(isTime ? "time a ray, median" : "evaluations a ray", Math.min(...costs) - 0.2, Math.max(...costs) + 0.25,
        (v) => (isTime ? nanoseconds(v) : short(v)));
      const points = list.map((row) => ({
        x: Math.log10(Math.max(row[cost], 0.1)), y: place(row[metric]), row, look: cells.get(row.cell), sign: sign(row, isTime),
        cost: row[cost], error: row[metric], whisker: isTime ? [Math.log10(row.ns_min), Math.log10(row.ns_p90)] : null,
      }));
      const front = paretoFront(points).map(({ x, y }) => ({ x, y }));
      const zeros = list.filter((r) => r[metric] === 0).length;
      const foot = isShare && zeros ? `none: ${zeros} of ${list.length} cells, none wrong of ${rays} rays: below ${percent(Math.min(1, 3 / rays))} (95 %).` : `${rays} rays.`;
      const best = paretoFront(points).map((p) => cells.get(p.row.cell).label).join("; ");
      addPanel(id, box, families.get(family).name, `${errorMetrics.get(metric)} against ${costMetrics.get(cost)}, family ${families.get(family).name}. Pareto front: ${best}.`,
        isShare && !zeros ? `${rays} rays.` : foot, {
          bands,
          data: { datasets: [
            { data: points, pointRadius: 0, pointHitRadius: 10, pointHoverRadius: 0, markSize: 5.5 },
            { type: "line", data: front, stepped: "before", borderColor: theme().soft, borderWidth: 1.2, borderDash: [2, 3], pointRadius: 0, pointHitRadius: 0 }] },
          options: { scales: { x, y }, interaction: { mode: "nearest", intersect: true } },
          callbacks: { title: (items) => items.map((i) => cells.get(i.raw.row.cell).label).join("\n"), label: (item) => describe(item.raw.row) },
        });
    }
  }

  // ---- figure 2
  const fewRecords = data.smallestBin;
  function drawCurves(now) {
    if (!curveSelect) return;
    const id = "curve-panels", box = clearPanels(id), metric = curveSelect.value, isShare = metric.endsWith("_share");
    const shown = curves.filter((r) => isShown(r, now) && r[metric] != null);
    if (shown.length === 0) nothing(box);
    for (const [family, list] of grouped(shown)) {
      const { name, knob } = families.get(family);
      const middles = list.filter((r) => r.from > 0 && r.to < Infinity).map((r) => 0.5 * (Math.log10(r.from) + Math.log10(r.to)));
      const low = middles.length ? Math.min(...middles) : 0, high = middles.length ? Math.max(...middles) : 0;
      const hasZero = list.some((r) => r.to === 0);
      const x = logAxis(knob, low - 0.3, high + 0.3, (v, k) => (Number.isInteger(k) ? power(k) : short(v)), hasZero ? [{ value: low - 1.2, label: "0" }] : []);
      const values = list.map((r) => r[metric]);
      const banded = isShare ? null : bandedAxis(values, false, "error", 1);
      const y = isShare ? { type: "linear", min: 0, suggestedMax: 0.01, title: { display: false }, ticks: { callback: percent } } : banded.axis;
      const byCell = new Map();
      for (const r of list) byCell.set(r.cell, [...(byCell.get(r.cell) ?? []), r]);
      const datasets = [...byCell].map(([cell, bins]) => {
        const look = cells.get(cell);
        const points = bins.map((row) => ({
          x: row.to === 0 ? low - 1.2 : row.to === Infinity ? high + 0.3 : 0.5 * (Math.log10(row.from) + Math.log10(row.to)),
          y: isShare ? row[metric] : banded.place(row[metric]), row, look, unmarked: row.records < fewRecords,
        }));
        points.sort((a, b) => a.x - b.x);
        const faint = (c) => (points[c.p0DataIndex].unmarked || points[c.p1DataIndex].unmarked ? `${look.colour}50` : look.colour);
        return { type: "line", segment: { borderColor: faint }, data: points, borderColor: look.colour, borderWidth: 1.4, borderDash: look.dash, pointRadius: 0, pointHitRadius: 8, pointHoverRadius: 0, markSize: 3.2, clip: 6 };
      });
      const counts = list.map((r) => r.records);
      addPanel(id, box, name, `${curveMetrics.get(metric)} against difficulty (${knob}), family ${name}.`, `${Math.min(...counts)} to ${Math.max(...counts)} records a bin and cell.`, {
        bands: banded?.bands, data: { datasets },
        options: { scales: { x, y }, interaction: { mode: "nearest", intersect: true } },
        callbacks: {
          title: (items) => items.slice(0, 4).map((i) => cells.get(i.raw.row.cell).label).join("\n"),
          label: ({ raw: { row } }) => [
            row.to === 0 ? "difficulty 0" : `${row.from.toExponential(1)} to ${row.to.toExponential(1)}`,
            `${row.records} records for ${short(row.rays)} rays`,
            `wrong ${percent(row.wrong_share)}, inexcusable ${percent(row.inexcusable_share)}`,
            `unsolved ${percent(row.unsolved_share)}`,
            `error, c.u.: median ${short(row.condition_units_p50)}, p99 ${short(row.condition_units_p99)}`],
        },
      });
    }
  }

  // ---- figure 4
  const zeroBin = -100000, infiniteBin = 100000;
  function drawDistributions(now) {
    if (!cdfSelect) return;
    const id = "cdf-panels", box = clearPanels(id), metric = cdfSelect.value;
    const shown = data.bins.filter((b) => b[2] === metric).map(([cell, family, , bin, count]) => ({ cell, family, bin, count })).filter((b) => isShown(b, now));
    if (shown.length === 0) nothing(box);
    for (const [family, list] of grouped(shown)) {
      const edges = list.filter((b) => b.bin > zeroBin && b.bin < infiniteBin).map((b) => ((b.bin + 1) / 4) * Math.log10(2));
      const low = edges.length ? Math.min(...edges) : 0, high = edges.length ? Math.max(...edges) : 1;
      const byCell = new Map();
      for (const b of list) byCell.set(b.cell, [...(byCell.get(b.cell) ?? []), b]);
      let place = 0;
      const datasets = [...byCell].map(([cell, bins]) => {
        const look = cells.get(cell);
        const total = bins.reduce((sum, b) => sum + b.count, 0);
        let below = 0;
        const points = bins.sort((a, b) => a.bin - b.bin).filter((b) => b.bin < infiniteBin).map((b) => {
          below += b.count;
          return { x: b.bin === zeroBin ? low - 0.6 : ((b.bin + 1) / 4) * Math.log10(2), y: below / total, cell, total, bin: b.bin, look };
        });
        if (points.length) points.push({ ...points.at(-1), x: high + 0.1 });
        // The marker stands once on each curve, at another place for each, so that curves can be told apart.
        const every = Math.max(points.length, 1);
        return { type: "line", data: points, stepped: "before", borderColor: look.colour, borderWidth: 1.4, borderDash: look.dash, pointRadius: 0, pointHitRadius: 6, pointHoverRadius: 0,
          markSize: 4, markEvery: every, markAt: Math.min(every - 1, Math.floor((every * (++place)) / (byCell.size + 1))) };
      });
      const extra = list.some((b) => b.bin === zeroBin) ? [{ value: low - 0.6, label: "0" }] : [];
      const x = logAxis(metricNames[metric], low - 0.1, high + 0.1, (v, k) => (Number.isInteger(k) ? power(k) : short(v)), extra);
      const y = { type: "linear", min: 0, max: 1, title: { display: false }, ticks: { callback: percent } };
      addPanel(id, box, families.get(family).name, `Cumulative distribution of the error in ${metricNames[metric]}, family ${families.get(family).name}.`, "", {
        data: { datasets }, options: { scales: { x, y }, interaction: { mode: "nearest", intersect: false } },
        callbacks: {
          title: (items) => items.slice(0, 4).map((i) => cells.get(i.raw.cell).label).join("\n"),
          label: ({ raw }) => `${percent(raw.y)} of ${raw.total} rays ${raw.bin === zeroBin ? "have no error" : `below ${short(2 ** ((raw.bin + 1) / 4))}`}`,
        },
      });
    }
  }

  // ---- legend keys
  const svg = (width, inner) => `<svg viewBox="0 0 ${width} 16" class="${width > 16 ? "dash" : ""}" aria-hidden="true">${inner}</svg>`;
  function keyMarker(shape, fill, colour, x) {
    const path = data.shapes[shape];
    const clip = { full: "", none: "inset(100%)", left: "inset(-2px 50% -2px -2px)", bottom: "inset(50% -2px -2px -2px)" }[fill];
    return `<g transform="translate(${x} 8) scale(5.5)"><path d="${path}" fill="${colour}" style="clip-path:${clip || "none"}"/><path d="${path}" fill="none" stroke="${colour}" stroke-width=".3"/></g>`;
  }
  for (const slot of document.querySelectorAll("[data-variant-key]")) {
    const cell = data.cells.find((c) => c.variant === slot.dataset.variantKey);
    slot.innerHTML = svg(16, keyMarker(cell.shape, "full", cell.colour, 8));
  }
  // Formulations look as on the surface that is shown; what it does not have is no choice.
  function drawKeys(now) {
    const own = data.cells.filter((c) => !now.surface || now.surface.has(c.surface));
    const asked = new Set(own.map((c) => c.id));
    const has = {
      variant: new Set(own.map((c) => c.variant)), formulation: new Set(own.map((c) => c.formulation)),
      family: new Set(rows.filter((r) => asked.has(r.cell)).map((r) => families.get(r.family).name)),
    };
    for (const [kind, names] of Object.entries(has)) {
      for (const box of boxes(kind)) box.closest("label").hidden = !names.has(box.value);
    }
    for (const slot of document.querySelectorAll("[data-formulation-key]")) {
      const cell = own.find((c) => c.formulation === slot.dataset.formulationKey);
      if (cell) slot.innerHTML = formulationKey(cell);
    }
  }
  function formulationKey(cell) {
    return svg(42, `<path d="M0 8H42" stroke="currentColor" stroke-width="1.4" stroke-dasharray="${cell.dash.join(" ")}"/>${keyMarker(0, cell.fill, "currentColor", 21)}`);
  }

  // ---- tables: filter, search, sort
  function filterTables(now) {
    for (const element of document.querySelectorAll("[data-surface], [data-family], [data-variant], [data-formulation]")) {
      const { surface, family, variant, formulation } = element.dataset;
      const words = element.closest("table")?.id ? (document.querySelector(`[data-table="${element.closest("table").id}"]`)?.value ?? "") : "";
      const text = words ? element.textContent.toLowerCase() : "";
      element.hidden = Boolean((surface && now.surface && !now.surface.has(surface)) || (family && !now.family.has(family)) ||
        (variant && !now.variant.has(variant)) || (formulation && !now.formulation.has(formulation)) ||
        (words && !words.toLowerCase().split(/\s+/).every((w) => text.includes(w))));
    }
  }

  function sortTable(header) {
    const table = header.closest("table"), body = table.tBodies[0], column = header.cellIndex;
    const descending = header.getAttribute("aria-sort") === "descending" ? false : header.getAttribute("aria-sort") === "ascending" ? true : header.classList.contains("num");
    for (const other of table.querySelectorAll("th[aria-sort]")) other.setAttribute("aria-sort", "none");
    header.setAttribute("aria-sort", descending ? "descending" : "ascending");
    const key = (row) => { const { v } = row.cells[column].dataset; return v === undefined ? row.cells[column].textContent.trim() : v === "" ? -Infinity : Number(v); };
    const compare = (a, b) => (typeof a === "number" ? a - b : String(a).localeCompare(String(b)));
    const sorted = [...body.rows].map((row) => [key(row), row]).sort((a, b) => (descending ? -1 : 1) * compare(a[0], b[0]));
    body.append(...sorted.map(([, row]) => row));
  }

  // ---- copy
  async function copy(text) {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      // Pages from disk may lack the clipboard interface: select and copy the old way.
      const area = Object.assign(document.createElement("textarea"), { value: text });
      document.body.append(area);
      area.select();
      const done = document.execCommand("copy");
      area.remove();
      return done;
    }
  }

  // ---- events
  function refresh() {
    const now = selection();
    drawKeys(now);
    filterTables(now);
    drawErrorTime(now);
    drawCurves(now);
    drawDistributions(now);
    const all = ["family", "variant", "formulation"].flatMap(boxes);
    const on = all.filter((b) => b.checked).length;
    document.getElementById("filter-state").textContent = on === all.length ? "" : `(${on} of ${all.length} on)`;
  }
  const filters = document.getElementById("filters");
  filters.addEventListener("change", refresh);
  filters.addEventListener("click", (event) => {
    if (!event.target.classList.contains("flip")) return;
    const list = [...event.target.closest("fieldset").querySelectorAll("input")];
    const on = !list.every((b) => b.checked);
    for (const b of list) b.checked = on;
    refresh();
  });
  if (matchMedia("(max-width: 640px), (max-height: 700px)").matches) filters.open = false;
  errorSelect.addEventListener("change", () => drawErrorTime(selection()));
  costSelect.addEventListener("change", () => drawErrorTime(selection()));
  curveSelect?.addEventListener("change", () => drawCurves(selection()));
  cdfSelect?.addEventListener("change", () => drawDistributions(selection()));
  for (const search of document.querySelectorAll("[data-table]")) search.addEventListener("input", () => filterTables(selection()));
  for (const button of document.querySelectorAll(".sort")) button.addEventListener("click", () => sortTable(button.closest("th")));
  document.addEventListener("click", async (event) => {
    const button = event.target.closest("[data-copy]");
    if (!button) return;
    const text = button.textContent;
    button.textContent = (await copy(button.dataset.copy)) ? "copied" : "failed";
    setTimeout(() => { button.textContent = text; }, 1200);
  });
  document.getElementById("copy-all")?.addEventListener("click", async () => {
    const lines = [...document.querySelectorAll("#worst-table tbody tr:not([hidden]) button[data-copy]:first-child")].map((b) => b.dataset.copy);
    const done = await copy(`${lines.join("\n")}\n`);
    document.getElementById("copy-state").textContent = done ? `${lines.length} rays copied` : "the browser refused to copy";
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", refresh);
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  refresh();
})();
