// The live page of --out http: (docs/http.md). Frames come as one stream that is read as they are
// shown, counters and controls as server-sent events.
"use strict";

const $ = (id) => document.getElementById(id);
const token = new URLSearchParams(location.search).get("token");
const withToken = (path) => path + (token ? "?token=" + encodeURIComponent(token) : "");
const later = (ms) => new Promise((done) => setTimeout(done, ms));
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// For tests, and for whoever looks from the console.
const seen = (window.eventide = { shown: 0, index: -1, connections: 0, message: null });

// ---- words ------------------------------------------------------------------------------------

function short(n) {
  if (!isFinite(n)) return "–";
  for (const [scale, unit] of [[1e9, " G"], [1e6, " M"], [1e3, " k"]])
    if (Math.abs(n) >= scale) return (n / scale).toFixed(n / scale < 10 ? 2 : 1) + unit;
  return n < 10 && n % 1 ? n.toFixed(1) : Math.round(n) + "";
}
const milliseconds = (ms) =>
  !isFinite(ms) ? "–" : ms >= 1000 ? (ms / 1000).toFixed(1) + " s" : ms.toFixed(ms < 10 ? 1 : 0) + " ms";

function setState(state, words) {
  $("state").dataset.state = state;
  $("state").querySelector("b").textContent = words;
}

// ---- sigma's colours --------------------------------------------------------------------------

// From clear through violet and orange to yellow; the alpha goes with it, so certain places stay as
// they are. RGBA as ImageData has it.
const kColours = new Uint32Array(256);
(function makeColours() {
  const stops = [[0, 60, 20, 120], [0.35, 150, 40, 140], [0.7, 240, 100, 50], [1, 255, 220, 80]];
  for (let i = 0; i < 256; ++i) {
    const at = i / 255;
    let k = 0;
    while (k < stops.length - 2 && at > stops[k + 1][0]) ++k;
    const [a, b] = [stops[k], stops[k + 1]];
    const share = (at - a[0]) / (b[0] - a[0]);
    const colour = [1, 2, 3].map((c) => Math.round(a[c] + share * (b[c] - a[c])));
    const alpha = Math.round(255 * Math.min(1, at * 1.6));
    kColours[i] = ((alpha << 24) | (colour[2] << 16) | (colour[1] << 8) | colour[0]) >>> 0;
  }
  const canvas = $("ramp"), context = canvas.getContext("2d");
  const ramp = context.createImageData(canvas.width, canvas.height);
  const words = new Uint32Array(ramp.data.buffer);
  for (let i = 0; i < words.length; ++i)
    words[i] = (kColours[Math.round(((i % canvas.width) / (canvas.width - 1)) * 255)] | 0xff000000) >>> 0;
  context.putImageData(ramp, 0, 0);
})();

function eventColours() {
  const word = (name) => {
    const hex = css(name);
    const [r, g, b] = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
    return ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
  };
  return { on: word("--on"), off: word("--off"), none: word("--none") };
}

// ---- frames -----------------------------------------------------------------------------------

const kHead = 64, kMagic = 0x45545645, kMostMessage = 64 << 20;

/// One message, as ShownFrame::message() writes it.
function parse(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const number = (at) => Number(view.getBigUint64(at, true));
  const lengths = [48, 52, 56].map((at) => view.getUint32(at, true));
  const message = {
    index: number(8), t_us: Number(view.getBigInt64(16, true)), events: number(24),
    latency_ms: number(32) / 1000, window_ms: number(40) / 1000, gap: view.getUint32(60, true) & 1,
  };
  let at = kHead;
  for (const [i, name, type] of [[0, "intensity", "image/jpeg"], [1, "sigma", "image/jpeg"],
                                 [2, "preview", "image/png"]]) {
    const part = bytes.subarray(at, at += lengths[i]);
    if (part.length) message[name] = new Blob([part], { type });
  }
  return message;
}

/// Cuts a stream of bytes into messages; those that came at once are one array at most.
async function* messages(reader) {
  let have = new Uint8Array(1 << 16), size = 0;
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    if (size + value.length > have.length) {
      const larger = new Uint8Array(Math.max(2 * have.length, size + value.length));
      larger.set(have.subarray(0, size));
      have = larger;
    }
    have.set(value, size);
    size += value.length;
    let begin = 0;
    while (size - begin >= kHead) {
      const view = new DataView(have.buffer, begin, kHead);
      const length = kHead + view.getUint32(48, true) + view.getUint32(52, true) + view.getUint32(56, true);
      if (view.getUint32(0, true) !== kMagic || length > kMostMessage) throw new Error("not a frame");
      if (size - begin < length) break;
      yield have.slice(begin, begin + length);
      begin += length;
    }
    have.copyWithin(0, begin, size);
    size -= begin;
  }
}

let newest = null, drawing = false;
const scratch = document.createElement("canvas");

function fit(canvas, bitmap) {
  if (canvas.width === bitmap.width && canvas.height === bitmap.height) return;
  canvas.width = bitmap.width;
  canvas.height = bitmap.height;
}

/// A grey image through a table, into `canvas`.
function paint(canvas, bitmap, colour) {
  fit(canvas, bitmap);
  fit(scratch, bitmap);
  const from = scratch.getContext("2d", { willReadFrequently: true });
  from.drawImage(bitmap, 0, 0);
  const pixels = from.getImageData(0, 0, bitmap.width, bitmap.height);
  const words = new Uint32Array(pixels.data.buffer);
  for (let i = 0; i < words.length; ++i) words[i] = colour(words[i] & 255);
  canvas.getContext("2d").putImageData(pixels, 0, 0);
}

let grey = null;  // sigma of what is shown, for the pixel under the mouse

async function draw(message) {
  const decode = (blob) => (blob ? createImageBitmap(blob) : null);
  const [intensity, sigma, preview] =
    await Promise.all([message.intensity, message.sigma, message.preview].map(decode));
  await new Promise(requestAnimationFrame);
  fit($("intensity"), intensity);
  $("intensity").getContext("2d", { willReadFrequently: true }).drawImage(intensity, 0, 0);
  $("sigma").hidden = !sigma;
  grey = sigma;
  if (sigma && Number($("opacity").value) > 0) paint($("sigma"), sigma, (v) => kColours[v]);
  if (preview) {
    const colours = eventColours();
    paint($("events"), preview, (v) => (v > 200 ? colours.on : v < 60 ? colours.off : colours.none));
  }
  $("notice").hidden = true;
  $("time").textContent = (message.t_us / 1e6).toFixed(3) + " s";
  $("index").textContent = message.index;
  $("size").textContent = intensity.width + " × " + intensity.height;
  $("window-events").textContent = short(message.events) + " in " + milliseconds(message.window_ms);
  ++seen.shown;
  seen.index = message.index;
  latencies.push(message.latency_ms);
}

/// The newest that has come, when the one before is on the screen.
async function show() {
  if (drawing) return;
  drawing = true;
  try {
    while (newest) {
      const message = newest;
      newest = null;
      await draw(message);
    }
  } catch (error) {
    console.warn("a frame was not shown:", error);
  }
  drawing = false;
}

async function watchFrames() {
  for (;;) {
    try {
      const answer = await fetch(withToken("frames"), { cache: "no-store" });
      if (!answer.ok) throw new Error((await answer.text()).trim());
      ++seen.connections;
      for await (const bytes of messages(answer.body.getReader())) {
        newest = parse(bytes);
        show();
      }
      notice("The source has ended; waiting for it to come back");
    } catch (error) {
      notice(error instanceof TypeError ? "No connection; trying again" : error.message);
    }
    await later(1000);
  }
}

function notice(words) {
  $("notice").textContent = words;
  $("notice").hidden = false;
}

// ---- controls ---------------------------------------------------------------------------------

const rows = new Map();  // name -> what was made for it
let wanted = {}, sending = false;

const isLogarithmic = (c) => c.least > 0 && c.most / c.least >= 100;
const toSlider = (c, v) => (isLogarithmic(c) ? Math.log(v / c.least) / Math.log(c.most / c.least) : v);
const fromSlider = (c, v) => (isLogarithmic(c) ? c.least * Math.pow(c.most / c.least, v) : v);
const rounded = (c, v) =>
  Math.min(c.most, Math.max(c.least, Number((c.least + Math.round((v - c.least) / c.step) * c.step).toFixed(6))));

function makeRow(control) {
  const row = document.createElement("div");
  row.className = "control";
  row.innerHTML = '<label></label><span class="value"></span><input type="range"><span class="why"></span>';
  const [label, value, slider, why] = row.children;
  label.textContent = control.label;
  slider.id = "control-" + control.name;
  label.htmlFor = slider.id;
  const made = { row, value, slider, why, held: -Infinity, control };
  slider.addEventListener("input", () => {
    const c = made.control, v = rounded(c, fromSlider(c, Number(slider.value)));
    made.held = performance.now();
    sayValue(made, v);
    change(c.name, v);
  });
  $("controls").append(row);
  rows.set(control.name, made);
  return made;
}

function sayValue(made, value) {
  const unit = document.createElement("small");
  unit.textContent = made.control.text ? "" : " " + made.control.unit;
  made.value.replaceChildren(made.control.text || String(Number(value.toFixed(3))), unit);
}

function showControls(controls) {
  for (const control of controls) {
    if (control.name === "pause") {
      const on = control.value !== 0;
      $("pause").disabled = false;
      $("pause").setAttribute("aria-pressed", on);
      $("pause").textContent = on ? "Resume" : "Pause";
      continue;
    }
    const made = rows.get(control.name) || makeRow(control);
    made.control = control;
    made.slider.hidden = !control.changeable;
    made.why.textContent = control.changeable ? "" : control.fixed || "";
    // What the user has in his hand is not moved under it.
    if (performance.now() - made.held < 1000) continue;
    const log = isLogarithmic(control);
    made.slider.min = log ? 0 : control.least;
    made.slider.max = log ? 1 : control.most;
    made.slider.step = log ? "any" : control.step;
    if (control.value !== null) made.slider.value = toSlider(control, control.value);
    sayValue(made, control.value ?? 0);
  }
}

/// One request at a time; what changes meanwhile goes with the next.
async function change(name, value) {
  wanted[name] = value;
  if (sending) return;
  sending = true;
  while (Object.keys(wanted).length) {
    const body = JSON.stringify(wanted);
    wanted = {};
    try {
      const answer = await fetch(withToken("controls"), {
        method: "POST", headers: { "Content-Type": "application/json" }, body,
      });
      if (!answer.ok) throw new Error((await answer.text()).trim());
      $("refusal").textContent = "";
      showControls(await answer.json());
    } catch (error) {
      $("refusal").textContent = error.message;
    }
  }
  sending = false;
}

// ---- counters and plots -----------------------------------------------------------------------

const kSpan = 60_000;  // ms shown
let latencies = [], last = null, lastMessage = 0, lastShown = { at: performance.now(), shown: 0 };

class Plot {
  constructor(canvas, colours, words) {
    Object.assign(this, { canvas, colours, words, points: [] });
  }
  add(now, ...values) {
    this.points.push([now, ...values]);
    while (this.points.length && now - this.points[0][0] > kSpan) this.points.shift();
    this.draw(now);
  }
  draw(now) {
    const ratio = window.devicePixelRatio || 1;
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const c = this.canvas.getContext("2d");
    c.scale(ratio, ratio);
    const most = Plot.above(Math.max(0, ...this.points.flatMap((p) => p.slice(1).filter(isFinite))));
    const bottom = height - 14, y = (v) => bottom - (v / most) * (bottom - 4);
    const x = (t) => width - ((now - t) / kSpan) * width;
    c.font = "10px system-ui, sans-serif";
    c.fillStyle = css("--quiet");
    c.strokeStyle = css("--line");
    c.lineWidth = 1;
    for (const share of [0, 0.5, 1]) {
      c.beginPath();
      c.moveTo(0, Math.round(y(most * share)) + 0.5);
      c.lineTo(width, Math.round(y(most * share)) + 0.5);
      c.stroke();
    }
    c.fillText(this.words(most), 2, y(most) + 10);
    c.fillText("−60 s", 2, height - 2);
    c.textAlign = "right";
    c.fillText("now", width - 2, height - 2);
    c.textAlign = "left";
    this.colours.forEach((colour, i) => this.line(c, x, y, i + 1, css(colour)));
  }
  line(c, x, y, which, colour) {
    c.strokeStyle = colour;
    c.lineWidth = 1.5;
    c.beginPath();
    let before = null;  // no line over what was not measured
    for (const point of this.points) {
      const value = point[which];
      if (isFinite(value)) {
        if (before !== null && point[0] - before < 1500) c.lineTo(x(point[0]), y(value));
        else c.moveTo(x(point[0]), y(value));
        before = point[0];
      }
    }
    c.stroke();
  }
  /// 1, 2 or 5 times a power of ten.
  static above(v) {
    if (!(v > 0)) return 1;
    const power = Math.pow(10, Math.floor(Math.log10(v)));
    return [1, 2, 5, 10].map((n) => n * power).find((n) => n >= v * 1.05) || 20 * power;
  }
}

const perSecond = (n) => short(n) + "/s";
const plots = {
  events: new Plot($("plot-events"), ["--accent"], perSecond),
  frames: new Plot($("plot-frames"), ["--quiet", "--accent"], perSecond),
  latency: new Plot($("plot-latency"), ["--warn", "--accent"], milliseconds),
};

/// What went wrong between a camera and the machine, of what the server counts as that.
function incidents(camera, names) {
  return Object.entries(camera || {})
    .filter(([name, count]) => names.includes(name) && count > 0)
    .map(([name, count]) => ["Camera: " + name.replaceAll("_", " "), count, true]);
}

function showCounters(run, incidentNames) {
  const lines = [
    ["Events", run.events], ["Event windows", run.event_windows], ["Frames", run.frames],
    ["Lost packets", run.lost_packets, true], ["Skipped frames", run.skipped_frames, true],
    ["Merged windows", run.merged_windows, true], ["Gaps", run.gaps, true],
    ["Damaged", Object.values(run.damaged).reduce((a, b) => a + b, 0), true],
    ...incidents(run.camera, incidentNames),
  ];
  $("counters").replaceChildren(...lines.map(([name, value, warns]) => {
    const row = document.createElement("tr");
    for (const text of [name, short(value)]) row.insertCell().textContent = text;
    row.className = warns && value > 0 ? "bad" : "";
    return row;
  }));
}

const median = (values) => values.slice().sort((a, b) => a - b)[values.length >> 1];

function showStatistics(message) {
  const now = performance.now(), run = message.run;
  seen.message = message;
  lastMessage = now;
  showControls(message.controls);
  const paused = message.controls.some((c) => c.name === "pause" && c.value !== 0);
  setState(paused ? "waiting" : "live", paused ? "paused" : "live");
  $("viewers").textContent = message.viewers + " of " + message.most_viewers;
  $("white").textContent = Number(message.sigma_white.toFixed(3));
  if (!run) return;
  showCounters(run, message.camera_incidents);
  // Over a second: frames come in groups, one for each event window.
  if (!last || run.elapsed_s < last.elapsed_s) last = { ...run, at: now };
  const passed = run.elapsed_s - last.elapsed_s;
  if (passed < 1) return;
  const rate = (run.frames - last.frames) / passed;
  const shown = ((seen.shown - lastShown.shown) * 1000) / (now - lastShown.at);
  lastShown = { at: now, shown: seen.shown };
  last = { ...run, at: now };
  const middle = median(latencies), worst = Math.max(...latencies);
  latencies = [];
  plots.events.add(now, run.event_rate);
  plots.frames.add(now, shown, rate);
  plots.latency.add(now, worst, middle);
  $("event-rate").textContent = perSecond(run.event_rate);
  $("frame-rate").textContent = rate.toFixed(1) + "/s";
  $("shown-rate").textContent = shown.toFixed(1) + "/s";
  $("latency").textContent = milliseconds(middle);
  seen.rate = rate;
}

function watchStatistics() {
  const stream = new EventSource(withToken("stats"));
  stream.onmessage = (event) => showStatistics(JSON.parse(event.data));
  stream.onerror = () => {
    setState("gone", "no connection");
    $("pause").disabled = true;
    stream.close();
    setTimeout(watchStatistics, 1000);
  };
}

// ---- the rest ---------------------------------------------------------------------------------

$("pause").addEventListener("click", () =>
  change("pause", $("pause").getAttribute("aria-pressed") === "true" ? 0 : 1));

async function snapshot(path, name) {
  try {
    const answer = await fetch(withToken(path), { cache: "no-store" });
    if (!answer.ok) throw new Error((await answer.text()).trim());
    const link = document.createElement("a");
    link.href = URL.createObjectURL(await answer.blob());
    link.download = name.replace("#", answer.headers.get("X-Time-Us") || "frame");
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  } catch (error) {
    $("refusal").textContent = error.message;
  }
}
$("png").addEventListener("click", () => snapshot("frame.png", "frame_#us.png"));
$("tiff").addEventListener("click", () => snapshot("sigma.tiff", "sigma_#us.tiff"));

const setOpacity = () => ($("sigma").style.opacity = $("opacity").value);
$("opacity").addEventListener("input", setOpacity);
setOpacity();

/// What is under the mouse, in pixels of the frame.
$("intensity").addEventListener("mousemove", (event) => {
  const canvas = $("intensity"), box = canvas.getBoundingClientRect();
  const scale = Math.min(box.width / canvas.width, box.height / canvas.height);
  const x = Math.floor((event.clientX - box.left - (box.width - canvas.width * scale) / 2) / scale);
  const y = Math.floor((event.clientY - box.top - (box.height - canvas.height * scale) / 2) / scale);
  if (x < 0 || y < 0 || x >= canvas.width || y >= canvas.height) return void ($("pixel").textContent = "");
  const value = canvas.getContext("2d").getImageData(x, y, 1, 1).data[0] / 255;
  let words = `x ${x}  y ${y}  intensity ${value.toFixed(2)}`;
  if (grey) {
    fit(scratch, grey);
    const from = scratch.getContext("2d", { willReadFrequently: true });
    from.drawImage(grey, 0, 0);
    const white = seen.message ? seen.message.sigma_white : 0.3;
    words += `  sigma ${((from.getImageData(x, y, 1, 1).data[0] / 255) * white).toFixed(3)}`;
  }
  $("pixel").textContent = words;
});
$("intensity").addEventListener("mouseleave", () => ($("pixel").textContent = ""));

document.addEventListener("keydown", (event) => {
  if (event.key === " " && event.target === document.body && !$("pause").disabled) {
    event.preventDefault();
    $("pause").click();
  }
});

watchFrames();
watchStatistics();
