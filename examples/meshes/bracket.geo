// A bent bracket of sheet metal, in millimetres: quadratic tetrahedra.
//     gmsh bracket.geo -3
SetFactory("OpenCASCADE");

t = 4;      // thickness of the sheet
r = 4;      // inner radius of the bend
R = r + t;  // outer radius

// The profile in the plane y = 0: base along x, bend, upright along z.
Point(1) = {R, 0, 0};   Point(2) = {40, 0, 0};
Point(3) = {40, 0, t};  Point(4) = {R, 0, t};
Point(5) = {t, 0, R};   Point(6) = {t, 0, 50};
Point(7) = {0, 0, 50};  Point(8) = {0, 0, R};
Point(9) = {R, 0, R};   // centre of the bend
Line(1) = {1, 2};  Line(2) = {2, 3};  Line(3) = {3, 4};  Circle(4) = {4, 9, 5};
Line(5) = {5, 6};  Line(6) = {6, 7};  Line(7) = {7, 8};  Circle(8) = {8, 9, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7, 8};
Plane Surface(1) = {1};
sheet[] = Extrude {0, 30, 0} { Surface{1}; };

// Two holes for bolts in the base, an eye in the upright.
Cylinder(11) = {28, 8, -1, 0, 0, t + 2, 3};
Cylinder(12) = {28, 22, -1, 0, 0, t + 2, 3};
Cylinder(13) = {-1, 15, 40, t + 2, 0, 0, 5};
BooleanDifference{ Volume{sheet[1]}; Delete; }{ Volume{11, 12, 13}; Delete; }

// The groups of the input. The file has physical groups only.
e = 0.01;
Physical Volume("aluminium") = Volume{:};
Physical Surface("bolts") = {
    Surface In BoundingBox{25 - e, 5 - e, -e, 31 + e, 11 + e, t + e},
    Surface In BoundingBox{25 - e, 19 - e, -e, 31 + e, 25 + e, t + e}};
Physical Surface("eye") =
    Surface In BoundingBox{-e, 10 - e, 35 - e, t + e, 20 + e, 45 + e};

Mesh.MeshSizeMax = 9;
Mesh.MeshSizeFromCurvature = 6;
Mesh.ElementOrder = 2;
Mesh.HighOrderOptimize = 1;
Mesh.MshFileVersion = 4.1;
Mesh.Binary = 1;
