// A cylindrical arch dam of 60 m in three blocks, for Gmsh (gmsh -3 gmsh_arch.geo).
// The groups of surfaces JOINT1 and JOINT2 lie inside the mesh, between the blocks.
SetFactory("Built-in");
radius = 100; thickness = 12; height = 60; // [m]
angle[] = {-40, -13, 13, 40};              // of the block ends from the crown [degrees]
across = 2; along = 6; up = 8;             // elements of a block
centre = newp; Point(centre) = {0, 0, 0};
For k In {0:3}
  a = angle[k] * Pi / 180;
  inner[k] = newp; Point(inner[k]) = {radius * Sin(a), radius * Cos(a), 0};
  outer[k] = newp;
  Point(outer[k]) = {(radius + thickness) * Sin(a), (radius + thickness) * Cos(a), 0};
  side[k] = newl; Line(side[k]) = {inner[k], outer[k]};
  Transfinite Curve {side[k]} = across + 1;
EndFor
For k In {0:2}
  down = newl; Circle(down) = {inner[k], centre, inner[k + 1]};
  water = newl; Circle(water) = {outer[k], centre, outer[k + 1]};
  Transfinite Curve {down, water} = along + 1;
  loop = newll; Curve Loop(loop) = {down, side[k + 1], -water, -side[k]};
  base[k] = news; Plane Surface(base[k]) = {loop};
  Transfinite Surface {base[k]}; Recombine Surface {base[k]};
  new[] = Extrude {0, 0, height} { Surface{base[k]}; Layers{up}; Recombine; };
  block[k] = new[1]; downstream[k] = new[2]; right[k] = new[3]; upstream[k] = new[4];
  left[k] = new[5];
EndFor
Physical Volume("DAM") = {block[]};
Physical Surface("BASE") = {base[]};
Physical Surface("UPSTREAM") = {upstream[]};
Physical Surface("DOWNSTREAM") = {downstream[]};
Physical Surface("ABUTMENTS") = {left[0], right[2]};
Physical Surface("JOINT1") = {right[0]};
Physical Surface("JOINT2") = {right[1]};
