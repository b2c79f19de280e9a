"""An independent reference of plastic-damage concrete (paper, Eqs. 14-25; paper_notes.md, 7-13).

It is independent of the program: no return map, but the rate equations, integrated by an adaptive
scheme of scipy with error control (LSODA); six stress components and numerical eigenvalues instead
of principal axes; numerical gradients instead of derived ones. To be read in this order:

- `curves`: strength and damage against plastic strain, from the tables of the deck; - `concrete`:
the constants, the yield function, the flow and the damage; - `rates`: rates of a point under
strain; - `path`: a point on a path of legs of given strains and stresses; - `viscous`: Duvaut and
Lions' relaxation of a path; - `closed_forms`: results without integration.

Stress and strain vectors: 11 22 33 12 13 23, engineering shear strain, tension positive.
"""
