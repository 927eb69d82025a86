// SPDX-License-Identifier: Apache-2.0
// How the HTML report looks: on a wide screen, on a phone and on paper.
#pragma once

namespace fathom::reproduce {

inline constexpr const char* kStyle = R"css(
:root{--ink:#1c2733;--soft:#5b6875;--line:#dfe5eb;--page:#fbfcfd;--blue:#0b66a8}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);
font:17px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif}
header,main{max-width:1080px;margin:0 auto;padding:0 20px}
header{padding-top:36px}
h1{font-size:2em;line-height:1.2;margin:0 0 8px}
.subtitle{color:var(--soft);font-size:1.08em;margin:0 0 8px;max-width:46em}
h2{font-size:1.4em;margin:2em 0 .5em;padding-top:.6em;border-top:2px solid var(--line)}
p,ul,ol{max-width:46em}
a{color:var(--blue)}
code,pre{font:0.9em/1.5 ui-monospace,SFMono-Regular,Menlo,Consolas,"DejaVu Sans Mono",monospace}
pre{background:#eef2f6;padding:10px 14px;border-radius:6px;white-space:pre-wrap;
overflow-wrap:anywhere}
pre span{display:block;padding-left:2ch;text-indent:-2ch}
nav{background:#fff;border:1px solid var(--line);border-radius:8px;padding:2px 22px 8px;
margin-top:28px}
nav h2{border:0;font-size:1.05em;margin:.4em 0 0;padding-top:.4em}
nav ol{columns:2;column-gap:40px;margin:.4em 0;max-width:none}
.scroll{overflow-x:auto;margin:1em 0}
table{border-collapse:collapse;background:#fff;font-size:.9em;font-variant-numeric:tabular-nums;
min-width:min(100%,420px)}
caption{text-align:left;color:var(--soft);padding:0 0 6px;font-size:1.02em}
th,td{border-bottom:1px solid var(--line);padding:6px 10px;text-align:left;vertical-align:top}
th{background:#eef2f6;font-weight:600}
.r{text-align:right}td.r{white-space:nowrap}td:first-child{min-width:6.5em}
.mark{display:inline-block;padding:1px 9px;border-radius:11px;font-weight:600;white-space:nowrap}
.holds{background:#d9f0e3;color:#14633c}
.partly{background:#fdeecb;color:#7a5200}
.fails{background:#fadcdc;color:#8f1d22}
figure{margin:1.4em 0;background:#fff;border:1px solid var(--line);border-radius:8px;padding:10px}
.pictures{display:grid;gap:8px}
.n2 .pictures{grid-template-columns:repeat(auto-fit,minmax(min(100%,420px),1fr))}
.n3 .pictures{grid-template-columns:repeat(auto-fit,minmax(min(100%,330px),1fr))}
.pictures svg{display:block;width:100%;height:auto}
figcaption{color:var(--soft);font-size:.92em;padding:6px 8px 2px;max-width:60em}
.notice{background:#fdeecb;border-left:5px solid #e0a100;padding:10px 14px;border-radius:4px}
.missing{background:#f3f4f6;color:var(--soft);padding:30px 14px;text-align:center;border-radius:6px}
main{padding-bottom:60px}
@media(max-width:720px){
body{font-size:16px}header,main{padding-left:14px;padding-right:14px}h1{font-size:1.55em}
nav ol{columns:1}figure{padding:4px;margin-left:-8px;margin-right:-8px}
.pictures{overflow-x:auto}.n1 svg{min-width:560px}
.folds thead{display:none}
.folds,.folds tbody,.folds tr,.folds td{display:block;width:100%}
.folds tr{border:1px solid var(--line);border-radius:8px;margin:0 0 10px;padding:6px 4px}
.folds td{border:0;padding:3px 10px;text-align:left;white-space:normal}
.folds td::before{content:attr(data-label) ": ";color:var(--soft);font-size:.92em}
.folds td:first-child{font-weight:600}.folds td:first-child::before{content:""}
}
@media print{
body{background:#fff;font-size:10.5pt}header,main{max-width:none;padding:0}
figure,tr,pre{break-inside:avoid}h2{break-after:avoid}a{color:inherit;text-decoration:none}
.scroll{overflow:visible}.mark{border:1px solid #999}
}
)css";

}  // namespace fathom::reproduce
