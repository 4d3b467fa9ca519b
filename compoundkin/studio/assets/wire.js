// How questions get to what replies: over the socket of a server on this machine, or through a widget's model.
const AGAIN = 1000; // milliseconds until a server that has gone is looked for again
const REFUSED = 1008;

export class SocketWire {
  constructor(token, { opened, lost }) {
    Object.assign(this, { token, opened, lost, waiting: new Map(), count: 0, isOpen: false, wasOpen: false });
    this.#connect();
  }

  #connect() {
    const socket = new WebSocket(`ws://${location.host}/talk`);
    this.socket = socket;
    socket.addEventListener("open", () => socket.send(JSON.stringify({ token: this.token })));
    socket.addEventListener("close", ({ code }) => {
      this.isOpen = false;
      if (this.isEnded) return;
      this.lost(this.wasOpen);
      if (code !== REFUSED || this.wasOpen) this.timer = setTimeout(() => this.#connect(), AGAIN);
    });
    socket.addEventListener("message", ({ data }) => {
      const reply = JSON.parse(data);
      if (reply.id === undefined) {
        [this.isOpen, this.wasOpen] = [true, true];
        this.opened(reply);
        // what was not replied before the server went
        for (const { text } of this.waiting.values()) socket.send(text);
        return;
      }
      this.waiting.get(reply.id)?.resolve(reply);
      this.waiting.delete(reply.id);
    });
  }

  ask(message) {
    const id = ++this.count, text = JSON.stringify({ id, ...message });
    return new Promise((resolve) => {
      this.waiting.set(id, { text, resolve });
      if (this.isOpen) this.socket.send(text);
    });
  }

  end() {
    this.isEnded = true;
    clearTimeout(this.timer);
    this.socket.close();
  }
}

// Messages are JSON texts, in a field of the messages that notebooks pass between a widget and its model.
export class ModelWire {
  constructor(model, { opened }) {
    Object.assign(this, { model, waiting: new Map(), count: 0 });
    this.heard = ({ text }) => {
      const reply = JSON.parse(text);
      if (reply.id === undefined) { opened(reply); return; }
      this.waiting.get(reply.id)?.(reply);
      this.waiting.delete(reply.id);
    };
    model.on("msg:custom", this.heard);
    model.send({ text: JSON.stringify({ hello: true }) });
  }

  ask(message) {
    const id = ++this.count;
    return new Promise((resolve) => {
      this.waiting.set(id, resolve);
      this.model.send({ text: JSON.stringify({ id, ...message }) });
    });
  }

  end() { this.model.off("msg:custom", this.heard); }
}
