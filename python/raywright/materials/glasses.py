"""Glass, crystals and water by measured indices of refraction."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from .dispersion import Sellmeier

# The coefficients B and C of Sellmeier's formula. Those of glasses are from Schott's data sheets.
_MEASURED: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    "N-BK7": ((1.03961212, 0.231792344, 1.01046945), (0.00600069867, 0.0200179144, 103.560653)),
    "N-K5": ((1.08511833, 0.199562005, 0.930511663), (0.00661099503, 0.024110866, 111.982777)),
    "N-BAK4": ((1.28834642, 0.132817724, 0.945395373), (0.00779980626, 0.0315631177, 105.965875)),
    "N-BAF10": ((1.5851495, 0.143559385, 1.08521269), (0.00926681282, 0.0424489805, 105.613573)),
    "N-FK51A": ((0.971247817, 0.216901417, 0.904651666), (0.00472301995, 0.0153575612, 168.68133)),
    "F2": ((1.34533359, 0.209073176, 0.937357162), (0.00997743871, 0.0470450767, 111.886764)),
    "SF5": ((1.46141885, 0.247713019, 0.949995832), (0.0111826126, 0.0508594669, 112.041888)),
    "SF10": ((1.61625977, 0.259229334, 1.07762317), (0.0127534559, 0.0581983954, 116.60768)),
    "N-SF10": ((1.62153902, 0.256287842, 1.64447552), (0.0122241457, 0.0595736775, 147.468793)),
    "N-SF5": ((1.52481889, 0.187085527, 1.42729015), (0.011254756, 0.0588995392, 129.141675)),
    "N-SF6": ((1.77931763, 0.338149866, 2.08734474), (0.0133714182, 0.0617533621, 174.01759)),
    "N-SF11": ((1.73759695, 0.313747346, 1.89878101), (0.013188707, 0.0623068142, 155.23629)),
    "N-LASF9": ((2.00029547, 0.298926886, 1.80691843), (0.0121426017, 0.0538736236, 156.530829)),
    # Malitson, "Interspecimen Comparison of the Refractive Index of Fused Silica", 1965.
    "fused silica": ((0.6961663, 0.4079426, 0.8974794), (0.0684043**2, 0.1162414**2, 9.896161**2)),
    # Malitson, "A Redetermination of Some Optical Properties of Calcium Fluoride", 1963.
    "CaF2": ((0.5675888, 0.4710914, 3.8484723), (0.050263605**2, 0.1003909**2, 34.649040**2)),
    # Malitson and Dodge, "Refractive Index and Birefringence of Synthetic Sapphire", 1972: the ordinary ray.
    "sapphire": ((1.4313493, 0.65054713, 5.3414021), (0.0726631**2, 0.1193242**2, 18.028251**2)),
    # Peter, "Über Brechungsindizes und Absorptionskonstanten des Diamanten zwischen 644 und 226 mµ", 1923.
    "diamond": ((4.3356, 0.3306), (0.106**2, 0.175**2)),
    # Daimon and Masumura, "Measurement of the Refractive Index of Distilled Water from the Near-Infrared
    # Region to the Ultraviolet Region", 2007: at 20 °C.
    "water": (
        (0.5684027565, 0.1726177391, 0.02086189578, 0.1130748688),
        (0.005101829712, 0.01821153936, 0.02620722293, 10.69792721),
    ),
}


class Glasses(Mapping[str, Sellmeier]):
    """Clear materials by name: ``rw.materials.glasses["N-BK7"].index(0.5876)``.

    Raises
    ------
    KeyError
        If there is no such name; the error lists all names.
    """

    def __getitem__(self, name: str) -> Sellmeier:
        if name not in _MEASURED:
            raise KeyError(f"no glass {name!r}; there are {', '.join(_MEASURED)}")
        return Sellmeier(*_MEASURED[name])

    def __iter__(self) -> Iterator[str]:
        return iter(_MEASURED)

    def __len__(self) -> int:
        return len(_MEASURED)

    def __repr__(self) -> str:
        return f"Glasses({', '.join(_MEASURED)})"


glasses = Glasses()
