//! The report opened in a browser, with clicks on its switches.
//!
//! A headless Chromium loads the page with an additional script. The script clicks, looks, and writes its findings into
//! the page; the page is then read back. Without a browser the test says so and passes, unless
//! `FEEDBITS_BROWSER=required`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command::feedbits_in;
use crate::message::text;

/// The additional script. Each line that it writes is a finding: a name, `=`, and the value found.
const VISIT: &str = r#"
<script>
window.addEventListener('load', () => {
  const found = [];
  const say = (name, what) => found.push(name + '=' + what);
  const box = document.querySelector('#switches input:checked');
  const run = box.dataset.run;
  const line = document.querySelector('#figure-fluctuation .run' + run + ' .line');
  const seen = () => line.getBoundingClientRect().width > 0;
  const drawn = () => [...document.querySelectorAll('#figure-fluctuation .line')].filter(l => l.getBoundingClientRect().width > 0).length;
  say('before', seen());
  const lines = drawn();
  box.click();
  say('off', seen());
  say('fewer', drawn() < lines);
  box.click();
  say('again', seen());
  document.querySelector('#switches button[data-all="0"]').click();
  say('none', drawn());
  document.querySelector('#switches button[data-all="1"]').click();
  say('all', drawn() > lines);
  const select = document.querySelector('#path select');
  const shown = () => [...document.querySelectorAll('#path figure')].filter(f => f.getBoundingClientRect().height > 0).map(f => f.id).join();
  const first = shown();
  select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
  select.dispatchEvent(new Event('change'));
  say('one path', first.length > 0 && !first.includes(',') && shown() !== first && !shown().includes(','));
  const paper = () => getComputedStyle(document.body).backgroundColor;
  const before = paper();
  document.getElementById('theme').click();
  say('theme', paper() !== before);
  const svg = document.querySelector('#figure-feed svg');
  svg.scrollIntoView();
  const place = svg.getBoundingClientRect();
  svg.dispatchEvent(new PointerEvent('pointermove', { clientX: place.left + place.width / 2, clientY: place.top + place.height / 2, bubbles: true }));
  const tip = document.getElementById('tip');
  say('tip', tip.hidden ? 'hidden' : /time \[s\]: 2\.\d+\nfeed +\d/.test(tip.textContent) || tip.textContent);
  say('answer', document.querySelector('#answer strong').textContent);
  const box2 = document.querySelector('#table .scroll');
  const cell = box2.querySelector('td');
  const left = cell.getBoundingClientRect().left;
  box2.scrollLeft = 400;
  say('format stays', Math.abs(cell.getBoundingClientRect().left - left) < 1);
  const half = document.getElementById('bits').getBoundingClientRect(), said = document.getElementById('answer').getBoundingClientRect();
  say('picture', innerWidth >= 1120 ? half.left >= said.right && half.top < said.bottom : half.top >= said.bottom);
  say('width used', document.querySelector('main').getBoundingClientRect().width >= Math.min(innerWidth, 1600) - 20);
  say('raw', document.querySelector('#table details:not([open]) .data') !== null);
  say('bits', /^25 bits are enough: I2F23/.test(document.querySelector('#answer .big').textContent));
  say('wide', document.documentElement.scrollWidth <= innerWidth);
  say('errors', window.errors.length + window.errors.join(';'));
  const note = document.createElement('pre');
  note.id = 'found';
  note.textContent = found.join('\n');
  document.body.append(note);
});
</script>
"#;

/// Errors of the page's own script are caught from its first line on.
const WATCH: &str = "<script>window.errors=[];window.addEventListener('error',e=>window.errors.push(e.message));\
                     console.error=(...a)=>window.errors.push(a.join(' '));</script>";

fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    names.iter().find_map(|name| folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file()))
}

/// The page after it has run, and what the browser logged.
fn visit(browser: &Path, folder: &Path, width: u32) -> (String, String) {
    let page = fs::read_to_string(folder.join("index.html")).expect("the page");
    let watched = page.replacen("<head>", &format!("<head>{WATCH}"), 1).replacen(
        "</body>",
        &format!("{VISIT}</body>"),
        1,
    );
    fs::write(folder.join("visited.html"), watched).expect("the folder is writable");
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--enable-logging=stderr",
        ])
        .args(["--virtual-time-budget=5000", "--dump-dom"])
        .arg(format!("--window-size={width},900"))
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("file://{}", folder.join("visited.html").display()))
        .output()
        .expect("the browser starts");
    (text(&output.stdout), text(&output.stderr))
}

#[test]
fn the_report_opens_without_an_error_and_its_switches_work() {
    let Some(browser) = browser() else {
        let required = std::env::var("FEEDBITS_BROWSER").is_ok_and(|value| value == "required");
        assert!(!required, "no browser was found: scripts/browser --install gets one");
        eprintln!("SKIPPED: no browser was found; scripts/browser --install gets one");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["compare", "--formats", "I16F16,I8F24,I4F28,f32,f64", "--report", "."];
    let run = feedbits_in(folder.path(), &arguments);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    for width in [1400, 900, 500] {
        let (page, log) = visit(&browser, folder.path(), width);
        let found = page.split("<pre id=\"found\">").nth(1).and_then(|rest| rest.split("</pre>").next());
        let found = found.unwrap_or_else(|| panic!("the script behind the page did not end\n{log}"));
        let expected = [
            "before=true",
            "off=false",
            "fewer=true",
            "again=true",
            "none=0",
            "all=true",
            "one path=true",
            "theme=true",
            "tip=true",
            "answer=I8F24",
            "format stays=true",
            "picture=true",
            "width used=true",
            "raw=true",
            "bits=true",
            "wide=true",
            "errors=0",
        ];
        assert_eq!(found.lines().collect::<Vec<_>>(), expected, "{width} pixels wide");
        let complaints: Vec<&str> = log.lines().filter(|line| line.contains("CONSOLE")).collect();
        assert!(complaints.is_empty(), "{complaints:?}");
    }
}
