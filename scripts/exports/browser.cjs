// Shows a page in headless Chromium and waits for what it reports.
const fs = require("fs");
const http = require("http");
const os = require("os");
const path = require("path");
const { spawn } = require("child_process");

const types = { ".js": "text/javascript", ".glb": "model/gltf-binary" };

function fail(reason) {
  console.error(reason);
  process.exit(1);
}

// The page finds the file of each address by `file`, and POSTs JSON to /report: what `finish` gets, or { error }.
function show({ page, file, minutes, finish }) {
  let browser;
  const server = http.createServer((request, response) => {
    if (request.url === "/report") {
      let body = "";
      request.on("data", (piece) => { body += piece; });
      request.on("end", () => {
        response.end();
        browser.kill();
        server.close();
        clearTimeout(timeout);
        const report = JSON.parse(body);
        if (report.error) fail(report.error);
        finish(report);
        process.exit(0);
      });
    } else if (request.url === "/") {
      response.setHeader("content-type", "text/html");
      response.end(page);
    } else {
      fs.readFile(file(request.url), (error, bytes) => {
        if (error) response.statusCode = 404;
        response.setHeader("content-type", types[path.extname(request.url)] || "text/plain");
        response.end(bytes);
      });
    }
  });
  const timeout = setTimeout(() => {
    browser.kill();
    fail(`no report from the page in ${minutes} minutes`);
  }, minutes * 60000);
  server.listen(0, "127.0.0.1", () => {
    const flags = ["--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", "--use-angle=swiftshader",
      "--user-data-dir=" + fs.mkdtempSync(path.join(os.tmpdir(), "page-"))];
    browser = spawn("chromium", [...flags, `http://127.0.0.1:${server.address().port}/`], { stdio: "ignore" });
  });
}

module.exports = { fail, show };
