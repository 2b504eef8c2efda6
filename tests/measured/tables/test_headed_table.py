"""Tables below headings: cells in quotes."""

import pytest

from crackfront.measured.tables.headed_table import table_of_numbers, table_of_texts


@pytest.mark.parametrize("table_of", [table_of_numbers, table_of_texts])
@pytest.mark.parametrize("quoted", ["{}", '"{}"'])
@pytest.mark.parametrize("separator", [",", ", ", ";", "\t"])
def test_a_heading_in_quotes_may_contain_separators(tmp_path, table_of, quoted, separator):
    rows = [['"Load, uN"', '"Radius; left; mean, um"'], *2 * [2 * [quoted.format("1.5")]]]
    path = tmp_path / "table.csv"
    path.write_text("".join(f"{separator.join(row)}\n" for row in rows))
    table = table_of(path)
    assert [heading.name for heading in table.headings] == ["Load", "Radius; left; mean"]
    assert [heading.unit for heading in table.headings] == ["uN", "um"]
    assert (table.cells == "1.5").to_numpy().all()
    assert table.cells.shape == (2, 2)


@pytest.mark.parametrize("table_of", [table_of_numbers, table_of_texts])
def test_an_endless_cell_is_an_error_of_the_file(tmp_path, table_of):
    path = tmp_path / "table.csv"
    path.write_text(f'Load,Radius\n"1",{200_000 * "b"}\n')
    with pytest.raises(ValueError, match=r"table\.csv"):
        table_of(path)
