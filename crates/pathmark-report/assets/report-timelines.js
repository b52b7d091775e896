"use strict";
// Timelines that are read job by job: the wheel or the buttons zoom, dragging moves, and what is under the pointer says which job it is.
(() => {
  const LANE = 18;
  const TALLEST = 260;
  const NUMBERS = 14;
  const TITLE = 22;
  const AXIS = 24;
  const LEFT = 34;
  // Dark to light as in the figure: by the rank of a job's time.
  const COLOURS = ["#4a1f66", "#7d2a70", "#b03c6b", "#dc5f5a", "#f18f5b", "#f6bd82"];

  // The workers of a replay, as the colours of series.
  const WORKERS = ["#0072b2", "#d55e00", "#008c67", "#c48600", "#be649b", "#3294cd", "#141414", "#808080"];
  // Milliseconds in which the longest schedule is replayed.
  const PLAY_MS = 8000;

  // A colour of figures, which are dark on a dark page.
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  const told = (microseconds) => (microseconds >= 1e3
    ? `${(microseconds / 1e3).toPrecision(4)} ms`
    : `${microseconds.toPrecision(4)} µs`);

  // Round steps of the time axis: 1, 2 or 5 times a power of ten.
  const stepOf = (span) => {
    const raw = span / 6;
    const power = 10 ** Math.floor(Math.log10(raw));
    return [1, 2, 5, 10].map((times) => times * power).find((step) => step >= raw);
  };

  const timeline = (figure, schedules) => {
    const end = Math.max(...schedules.map((schedule) => schedule.end));
    const times = schedules.flatMap((schedule) => schedule.jobs.map(([, , start, stop]) => stop - start)).sort((a, b) => a - b);
    if (times.length === 0) return;
    const rank = (time) => {
      let [low, high] = [0, times.length];
      while (low < high) {
        const middle = (low + high) >> 1;
        if (times[middle] < time) low = middle + 1; else high = middle;
      }
      return low / times.length;
    };
    const details = document.createElement("details");
    const summary = document.createElement("summary");
    summary.textContent = "Job by job, and on the picture";
    const tools = document.createElement("div");
    tools.className = "tools";
    const line = document.createElement("p");
    line.className = "job";
    line.textContent = "Zoom with the buttons or with Ctrl and the wheel, move by dragging, and point at a job.";
    const canvas = document.createElement("canvas");
    canvas.className = "timeline";
    // The line stays in sight above the lanes, however high they are.
    details.append(summary, tools, line, canvas);
    figure.append(details);

    const shown = { from: 0, to: end };
    const lanes = schedules.map((schedule) => Math.max(3, Math.min(LANE, TALLEST / Math.max(1, schedule.workers))));
    const heights = schedules.map((schedule, place) => TITLE + lanes[place] * schedule.workers);
    const height = heights.reduce((a, b) => a + b, AXIS);
    const x = (time, width) => LEFT + ((time - shown.from) / (shown.to - shown.from)) * (width - LEFT - 4);
    const time = (place, width) => shown.from + ((place - LEFT) / (width - LEFT - 4)) * (shown.to - shown.from);

    const draw = () => {
      const width = canvas.clientWidth || 800;
      const sharp = window.devicePixelRatio || 1;
      canvas.width = width * sharp;
      canvas.height = height * sharp;
      canvas.style.height = `${height}px`;
      const context = canvas.getContext("2d");
      context.scale(sharp, sharp);
      context.fillStyle = colour("--f-paper");
      context.fillRect(0, 0, width, height);
      context.font = "12px system-ui, sans-serif";
      context.textBaseline = "middle";
      let top = 0;
      schedules.forEach((schedule, place) => {
        context.fillStyle = colour("--f-ink");
        context.fillText(schedule.title, LEFT, top + TITLE / 2);
        const lane = lanes[place];
        const rim = lane >= 8 ? 1 : 0;
        for (let worker = 0; worker < schedule.workers; worker += Math.ceil(NUMBERS / lane)) {
          context.fillText(String(worker), 8, top + TITLE + lane * (worker + 0.5));
        }
        context.save();
        context.beginPath();
        context.rect(LEFT, top + TITLE, width - LEFT - 4, lane * schedule.workers);
        context.clip();
        schedule.jobs.forEach(([, worker, start, stop]) => {
          if (stop < shown.from || start > shown.to) return;
          const [left, right] = [x(start, width), x(stop, width)];
          context.fillStyle = COLOURS[Math.min(COLOURS.length - 1, Math.floor(rank(stop - start) * COLOURS.length))];
          context.fillRect(left, top + TITLE + lane * worker + rim, Math.max(right - left - 0.5, 0.5), lane - 2 * rim);
        });
        context.restore();
        context.strokeStyle = colour("--f-muted");
        const right = Math.min(Math.max(x(schedule.end, width), LEFT), width - 4);
        context.strokeRect(LEFT, top + TITLE, right - LEFT, lane * schedule.workers);
        top += heights[place];
      });
      context.fillStyle = colour("--f-ink");
      const step = stepOf(shown.to - shown.from);
      for (let tick = Math.ceil(shown.from / step) * step; tick <= shown.to; tick += step) {
        context.fillText(told(tick), Math.min(x(tick, width), width - 60), top + AXIS / 2);
      }
    };
    const move = (from, to) => {
      const span = Math.min(Math.max(to - from, 1), end);
      shown.from = Math.min(Math.max(from, 0), end - span);
      shown.to = shown.from + span;
      draw();
    };
    const zoom = (factor, at) => {
      const centre = at === undefined ? (shown.from + shown.to) / 2 : at;
      move(centre - (centre - shown.from) * factor, centre + (shown.to - centre) * factor);
    };
    const button = (label, act) => addButton(tools, label, act);
    button("Zoom in", () => zoom(0.5));
    button("Zoom out", () => zoom(2));
    button("All", () => move(0, end));
    button("Trace for Perfetto", () => {
      const events = schedules.flatMap((schedule, place) => [
        { name: "process_name", ph: "M", pid: place, args: { name: schedule.title } },
        ...schedule.jobs.map(([job, worker, start, stop]) => ({
          name: `job ${job}`, ph: "X", pid: place, tid: worker, ts: start, dur: stop - start,
        })),
      ]);
      save(new Blob([JSON.stringify({ traceEvents: events })], { type: "application/json" }), `${figure.id}.json`);
    });
    const where = document.createElement("a");
    where.href = "https://ui.perfetto.dev";
    where.textContent = "ui.perfetto.dev opens it";
    tools.append(where);

    // The same jobs on the picture: a tile has its worker's colour while its job runs, and a pale one when it is done.
    const pictures = schedules.filter((schedule) => schedule.size && schedule.size[0] > 0 && schedule.jobs.length > 0);
    if (pictures.length > 0) {
      const replay = document.createElement("div");
      replay.className = "replay";
      const controls = document.createElement("div");
      controls.className = "tools";
      const panes = document.createElement("div");
      panes.className = "stage";
      replay.append(controls, panes);
      canvas.before(replay);
      const slider = document.createElement("input");
      Object.assign(slider, { type: "range", min: 0, max: 1000, value: 1000 });
      slider.setAttribute("aria-label", "Time in the schedules");
      const drawn = pictures.map((schedule) => {
        const part = document.createElement("div");
        part.className = "pane";
        const caption = document.createElement("p");
        const picture = document.createElement("canvas");
        const scale = Math.max(1, Math.ceil(480 / schedule.size[0]));
        [picture.width, picture.height] = schedule.size.map((length) => length * Math.min(scale, 4));
        part.append(caption, picture);
        panes.append(part);
        return { schedule, caption, picture, scale: picture.width / schedule.size[0] };
      });
      const paint = () => {
        const now = (Number(slider.value) / 1000) * end;
        slider.setAttribute("aria-valuetext", told(now));
        drawn.forEach(({ schedule, caption, picture, scale }) => {
          const context = picture.getContext("2d");
          context.fillStyle = colour("--f-paper");
          context.fillRect(0, 0, picture.width, picture.height);
          let done = 0;
          schedule.jobs.forEach(([, worker, start, stop, [x0, y0, x1, y1]]) => {
            if (start > now) return;
            const runs = stop > now;
            done += runs ? 0 : 1;
            context.globalAlpha = runs ? 1 : 0.35;
            context.fillStyle = WORKERS[worker % WORKERS.length];
            context.fillRect(x0 * scale, y0 * scale, (x1 - x0) * scale - 0.5, (y1 - y0) * scale - 0.5);
          });
          context.globalAlpha = 1;
          caption.textContent = `${schedule.title.split(":")[0]}: ${done} of ${schedule.jobs.length} jobs after ${told(Math.min(now, schedule.end))}`;
        });
      };
      let timer = 0;
      const play = addButton(controls, "Play", () => {
        if (timer) {
          cancelAnimationFrame(timer);
          timer = 0;
          play.textContent = "Play";
          return;
        }
        if (Number(slider.value) >= 1000) slider.value = 0;
        const [from, began] = [Number(slider.value), performance.now()];
        play.textContent = "Pause";
        const step = (time) => {
          slider.value = Math.min(1000, from + (time - began) / PLAY_MS * 1000);
          paint();
          timer = Number(slider.value) < 1000 ? requestAnimationFrame(step) : 0;
          if (!timer) play.textContent = "Play";
        };
        timer = requestAnimationFrame(step);
      });
      controls.append(slider);
      slider.addEventListener("input", paint);
      details.addEventListener("toggle", paint);
    }

    // The job under the pointer.
    const found = (event) => {
      const box = canvas.getBoundingClientRect();
      const at = time(event.clientX - box.left, box.width);
      let y = event.clientY - box.top;
      for (let place = 0; place < schedules.length; place += 1) {
        const worker = Math.floor((y - TITLE) / lanes[place]);
        if (y < heights[place]) {
          const job = schedules[place].jobs.find(([, own, start, stop]) => own === worker && start <= at && at <= stop);
          return job && { schedule: schedules[place], job };
        }
        y -= heights[place];
      }
      return undefined;
    };
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons) {
        const by = (event.movementX / (canvas.clientWidth - LEFT - 4)) * (shown.to - shown.from);
        move(shown.from - by, shown.to - by);
        return;
      }
      const hit = found(event);
      if (!hit) return;
      const [job, worker, start, stop] = hit.job;
      line.textContent = `Job ${job} on worker ${worker}: ${told(stop - start)}, from ${told(start)} to ${told(stop)}. ${hit.schedule.title}`;
    });
    canvas.addEventListener("wheel", (event) => {
      // Without the key the page scrolls, as everywhere.
      if (!event.ctrlKey) return;
      event.preventDefault();
      const box = canvas.getBoundingClientRect();
      zoom(event.deltaY > 0 ? 1.25 : 0.8, time(event.clientX - box.left, box.width));
    }, { passive: false });
    details.addEventListener("toggle", draw);
    window.addEventListener("resize", draw);
  };

  document.querySelectorAll("script.jobs").forEach((data) => timeline(data.parentElement, JSON.parse(data.textContent)));
})();
