"""The page of a sweep: it opens on the result and its figures, and needs no other file."""

from base64 import b64decode

from crackfront.sweep.summary import summary_page

FIT = "# Hysteresis\n\nk is <b>no</b> constant.\n\n## The fit\n\n| a |\n| --- |\n| 1 |\n"


def test_the_page_opens_on_the_result_and_its_figures(tmp_path):
    picture = tmp_path / "factor.png"
    picture.write_bytes(bytes(range(256)) * 40)
    page = summary_page("sweep", FIT, {"k & s": picture}, {"steady": 3}, "seed: 1", {"commit": "c"})
    result, rest = page.split("</section>")
    assert "k is &lt;b&gt;no&lt;/b&gt; constant." in result
    assert "<figcaption>k &amp; s</figcaption>" in result
    data = result.split("base64,")[1].split('"')[0]
    assert b64decode(data) == picture.read_bytes()
    # The report of the workflow shows this part, and refuses longer lines.
    assert max(map(len, result.splitlines())) < 10_000
    assert rest.index("<h2>The fit</h2>") < rest.index("<td>steady (complete)</td><td>3</td>")
    assert "<pre>seed: 1</pre>" in rest
