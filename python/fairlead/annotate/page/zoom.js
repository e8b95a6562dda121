// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// Zoom and pan of an image in a scrolling box. The image is laid out larger, not transformed: a click then has the
// resolution of the screen at every zoom. Tells the page each new scale (screen pixels per image pixel).
window.fairlead = {
  attach(box, width, height) {
    const stage = box.firstElementChild;
    const fit = () => Math.min(box.clientWidth / width, box.clientHeight / height);
    let scale = 0;
    let told = null;
    const tell = () => {
      clearTimeout(told);
      told = setTimeout(() => emitEvent("scale", scale), 30);
    };
    const set = (wanted, x, y) => {
      const next = Math.min(Math.max(wanted, fit() * 0.5), 40);
      const left = (box.scrollLeft + x - stage.offsetLeft) / (scale || next);
      const top = (box.scrollTop + y - stage.offsetTop) / (scale || next);
      scale = next;
      stage.style.width = width * scale + "px";
      stage.style.height = height * scale + "px";
      box.scrollLeft = left * scale - x + stage.offsetLeft;
      box.scrollTop = top * scale - y + stage.offsetTop;
      tell();
    };
    const middle = () => [box.clientWidth / 2, box.clientHeight / 2];
    this.fit = () => set(fit(), 0, 0);
    this.by = (factor) => set(scale * factor, ...middle());
    this.region = (u0, v0, u1, v1) => {
      set(Math.min(box.clientWidth / (u1 - u0 + 1), box.clientHeight / (v1 - v0 + 1)) / 1.3, 0, 0);
      box.scrollLeft = ((u0 + u1 + 1) / 2) * scale + stage.offsetLeft - box.clientWidth / 2;
      box.scrollTop = ((v0 + v1 + 1) / 2) * scale + stage.offsetTop - box.clientHeight / 2;
    };
    box.addEventListener("wheel", (event) => {
      event.preventDefault();
      const frame = box.getBoundingClientRect();
      set(scale * Math.exp(-event.deltaY * 0.0015), event.clientX - frame.left, event.clientY - frame.top);
    }, { passive: false });
    let held = null;
    box.addEventListener("contextmenu", (event) => event.preventDefault());
    box.addEventListener("mousedown", (event) => {
      if (event.button === 0) return;
      event.preventDefault();
      held = [event.clientX, event.clientY, box.scrollLeft, box.scrollTop];
    });
    window.addEventListener("mousemove", (event) => {
      if (held === null) return;
      box.scrollLeft = held[2] - (event.clientX - held[0]);
      box.scrollTop = held[3] - (event.clientY - held[1]);
    });
    window.addEventListener("mouseup", () => { held = null; });
    this.fit();
  },
};
