"""Folders of tested walls for the tests."""

from pathlib import Path

HEADS = (
    "Test unit name,Cyclic / Monotonic,Joints,Stone,H [mm],L [mm],t [mm],H0 [mm],hb [mm],lb [mm],Ntot [kN],"
    '"Vmax,+ [kN]","Vmax,- [kN]",From test report: Failure type'
)
GRANITE = "WS.175,Monotonic,Dry,Granite,1200,1000,200,1325,150,200,179.8,61,,R"
SANDSTONE = "SW.100.1,Monotonic,Dry,Sandstone,900,1000,200,1000,100,200,103.6,49.2,,R"
CURVE = "displacement_mm,force_kN\n0,0\n1,30\n10,61\n20,60\n"


def write_folder(folder: Path, *rows: str, heads: str = HEADS, curve: str = CURVE, table: str = "tests.csv") -> Path:
    """A folder with a table, and a curve for each of its walls."""
    folder.mkdir(exist_ok=True)
    (folder / table).write_text("\n".join([heads, *rows]) + "\n", encoding="utf-8")
    for row in rows:
        (folder / f"{row.split(',')[0]}.csv").write_text(curve, encoding="utf-8")
    return folder
