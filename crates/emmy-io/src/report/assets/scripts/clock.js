// The one time cursor of the page: charts, motion and controls follow it.

class Clock {
  // `seconds`: what the whole motion takes at speed 1. A clock that repeats begins again at its end.
  constructor(start, end, { seconds = 10, repeats = false } = {}) {
    Object.assign(this, { start, end, seconds, repeats, time: start });
    this.speed = 1;
    this.isPlaying = false;
    this.followers = [];
  }

  follow(follower) {
    this.followers.push(follower);
    follower(this.time);
  }

  set(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.followers.forEach((follower) => follower(this.time));
  }

  get rate() {
    return (this.speed * (this.end - this.start)) / this.seconds;
  }

  play() {
    if (this.isPlaying || this.end <= this.start) return;
    if (this.time >= this.end) this.time = this.start;
    this.isPlaying = true;
    let last = null;
    const tick = (now) => {
      if (!this.isPlaying) return;
      const passed = last === null ? 0 : Math.min((now - last) / 1000, 0.25);
      last = now;
      const next = this.time + passed * this.rate;
      if (next >= this.end && !this.repeats) this.isPlaying = false;
      this.set(next >= this.end && this.repeats ? this.start + ((next - this.start) % (this.end - this.start)) : next);
      if (this.isPlaying) requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
    this.set(this.time);
  }

  pause() {
    this.isPlaying = false;
    this.set(this.time);
  }

  // To the next or the last one before of some times.
  step(times, count) {
    if (!times.length) return;
    const now = lastBefore(times, this.time);
    const isBetween = Math.abs(times[now] - this.time) > 1e-9 * Math.abs(this.end - this.start);
    const to = now + count + (count < 0 && isBetween ? 1 : 0);
    this.isPlaying = false;
    this.set(times[Math.min(Math.max(to, 0), times.length - 1)]);
  }
}
