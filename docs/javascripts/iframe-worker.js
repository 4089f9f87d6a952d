// Browsers start no workers in pages that are opened as files. The search of the documentation needs one: there it runs in a frame instead.
class FrameWorker extends EventTarget {
  constructor(url) {
    super();
    const frame = document.createElement("iframe");
    frame.hidden = true;
    this.ready = new Promise((resolve, reject) => {
      frame.addEventListener("load", () => {
        const scope = frame.contentWindow;
        scope.postMessage = data => this.dispatchEvent(new MessageEvent("message", { data }));
        const script = frame.contentDocument.createElement("script");
        script.src = url;
        script.addEventListener("load", () => resolve(scope));
        script.addEventListener("error", () => reject(new Error(`${url} cannot be loaded`)));
        frame.contentDocument.body.append(script);
      }, { once: true });
    });
    frame.srcdoc = "<!doctype html><body></body>";
    document.body.append(frame);
    this.frame = frame;
  }
  postMessage(data) {
    this.ready.then(scope => scope.dispatchEvent(new scope.MessageEvent("message", { data })));
  }
  terminate() {
    this.frame.remove();
  }
}
if (location.protocol === "file:") window.Worker = FrameWorker;
