//! The treatment of each card.

use super::super::account::{Entries, Treatment};

use Treatment::{LeftOut, NoEffect, Read, Refused};

const fn entries(treatment: Treatment, what: &'static str, names: &'static [&'static str]) -> Entries {
    Entries { treatment, what, names }
}

/// Every known card. Materials, loads, supports and damping are those of Emmy's input, so cards of materials have no
/// effect; what acts on the body beside them is counted in a note.
pub(in crate::mesh) const TABLE: &[Entries] = &[
    entries(Read, "grid points", &["GRID", "GRDSET"]),
    entries(Read, "coordinate systems", &["CORD1R", "CORD1C", "CORD1S", "CORD2R", "CORD2C", "CORD2S"]),
    entries(
        Read,
        "solid cells; those of meshio have an underscore at the end of their names",
        &["CTETRA", "CPENTA", "CHEXA", "CPYRAM", "CPYRA", "CTETRA_", "CPENTA_", "CHEXA_", "CPYRA_"],
    ),
    entries(
        Read,
        "faces of solid cells, or cells in plane strain",
        &[
            "CTRIA3", "CTRIA6", "CTRIAR", "CQUAD4", "CQUAD8", "CQUAD9", "CQUADR", "CPLSTN3", "CPLSTN4",
            "CPLSTN6", "CPLSTN8",
        ],
    ),
    entries(
        Read,
        "lines: links, or groups of nodes, with a note; `CBUSH` is a spring, too",
        &["CBAR", "CBEAM", "CBEND", "CROD", "CTUBE", "CBUSH", "CBUSH1D", "CVISC", "CGAP"],
    ),
    entries(
        Read,
        "properties of shells: such cells are not in plane strain",
        &["PSHELL", "PCOMP", "PCOMPG", "PLPLANE"],
    ),
    entries(
        Read,
        "properties of lines",
        &[
            "PBAR", "PBARL", "PBEAM", "PBEAML", "PBCOMP", "PBEND", "PROD", "PTUBE", "PBUSH", "PBUSH1D",
            "PVISC", "PGAP",
        ],
    ),
    entries(
        Read,
        "rigid elements, equations and their sets, unless a note gives a reason against it",
        &["RBE2", "RBE3", "RBAR", "RROD", "MPC", "MPCADD"],
    ),
    entries(
        Read,
        "masses, springs and dampers, unless a note gives a reason against it",
        &["CONM2", "CMASS1", "CMASS2", "CELAS1", "CELAS2", "CDAMP1", "CDAMP2"],
    ),
    entries(Read, "properties of masses, springs and dampers", &["PMASS", "PELAS", "PDAMP"]),
    entries(Read, "supports: their grid points are groups, with a note", &["SPC", "SPC1"]),
    entries(Read, "other files", &["INCLUDE"]),
    entries(
        NoEffect,
        "materials and properties, for the input has them",
        &[
            "MAT*", "PSOLID", "PLSOLID", "PCOMPS", "PELAS*", "PDAMP*", "PSHEAR", "PWELD", "PFAST", "PBUSHT",
            "PBUSH2D", "PBMSECT", "PBRSECT", "PCONEAX", "PBARN1", "PBEMN1", "PSHLN1", "PSLDN1", "PSHLN2",
            "CREEP", "TABLES1", "TABLEST", "TABLEM*", "BAROR", "BEAMOR", "MLAY*", "NSMADD",
        ],
    ),
    entries(
        NoEffect,
        "control of the analysis and its output",
        &[
            "PARAM", "MDLPRM", "EIG*", "TSTEP*", "NLPARM", "NLPCI", "NLSTEP", "FREQ*", "SET", "SET1", "SET2",
            "SET3", "PLOTEL*", "CBARAO", "ECHOON", "ECHOOFF", "OUTPUT", "OUTRCV", "DTI", "DMI", "DMIN",
            "ITER", "ADUM*", "LABEL", "ACCSSPT", "SWLDPRM", "VCCT", "MONITOR", "POINT",
        ],
    ),
    entries(
        NoEffect,
        "reduction to fewer unknowns",
        &["ASET*", "BSET*", "CSET*", "QSET*", "OMIT*", "USET*", "BNDFIX*", "BNDFREE*", "BNDFRE1", "DYNRED"],
    ),
    entries(
        NoEffect,
        "tables and sets of loads and constraints",
        &[
            "TABLED*", "TABRND*", "TABLRPC", "DELAY", "DPHASE", "SPCADD", "SPCOFF*", "RANDPS", "RANDT1",
            "SPOINT", "EPOINT",
        ],
    ),
    entries(
        NoEffect,
        "optimization",
        &[
            "DESVAR", "DESGLB", "DESOBJ", "DCONADD", "DCONSTR", "DDVAL", "DEQATN", "DEQUATN", "DLINK",
            "DOPTPRM", "DRESP*", "DSCREEN", "DTABLE*", "DV*", "TOPVAR", "TOMVAR", "DTPL", "DSIZE", "DSHAPE",
            "DCONTRB", "BLDOUT", "MODTRAK",
        ],
    ),
    entries(
        NoEffect,
        "conduction of heat",
        &[
            "CHBDY*", "PHBDY", "CONV*", "PCONV*", "QBDY*", "QVECT", "QVOL", "QHBDY", "RADBC", "RADCAV",
            "RADLST", "RADM*", "RADSET", "VIEW*", "TEMPBC",
        ],
    ),
    entries(
        LeftOut,
        "loads",
        &[
            "FORCE*", "MOMENT*", "PLOAD*", "GRAV", "ACCEL", "ACCEL1", "RFORCE*", "LOAD*", "DLOAD", "RLOAD*",
            "TLOAD*", "DAREA", "LSEQ", "SLOAD", "CLOAD", "PRESAX", "BOLT*", "BFORCE", "DEFORM", "NOLIN*",
            "ACSRCE", "ALOAD",
        ],
    ),
    entries(LeftOut, "temperatures", &["TEMP*"]),
    entries(
        LeftOut,
        "driven supports and initial conditions",
        &["SPCD", "SPCR", "SPC*", "TIC*", "IPSTRAIN", "ISTRESS"],
    ),
    entries(
        LeftOut,
        "other rigid elements and constraints",
        &[
            "RBE*", "RBAR*", "RTRPLT*", "RSPLINE", "RJOINT", "RSSCON", "RSPINT", "MPC*", "SUPORT*", "SUPAX",
            "AECOMP*", "RCONN",
        ],
    ),
    entries(
        LeftOut,
        "contact and glue",
        &[
            "BC*", "BSURF*", "BG*", "BLSEG", "BFRIC", "BWIDTH", "BOUTPUT", "BEDGE", "CONTACT", "TIE",
            "CWELD", "CFAST", "CSEAM",
        ],
    ),
    entries(LeftOut, "other masses", &["CONM1", "CMASS*", "NSM*"]),
    entries(
        LeftOut,
        "other springs, dampers and matrices",
        &["CELAS*", "CDAMP*", "CBUSH2D", "GENEL", "DMIG*", "TF", "TABDMP1", "CONROD"],
    ),
    entries(
        LeftOut,
        "shear panels, plane stress and bodies of revolution",
        &[
            "CSHEAR", "CPLSTS*", "CTRAX*", "CTRIAX*", "CQUADX*", "CTRIA", "CQUAD", "CCONEAX", "CCONE",
            "RINGAX", "AXIC", "AXIF", "CBEAM3", "CRAC2D", "CDUM*",
        ],
    ),
    entries(LeftOut, "superelements", &["SE*", "CSUP*", "RELEASE", "EXTRN", "EXTSEOUT"]),
    entries(
        LeftOut,
        "fluids and aerodynamics",
        &[
            "CHACAB", "CHACBR", "CAABSF", "CFLUID*", "CSLOT*", "MFLUID", "FSLIST", "FREEPT", "PRESPT",
            "RINGFL", "GRIDF", "GRIDS", "BDYLIST", "ACMODL", "ELIST", "AE*", "CAERO*", "PAERO*", "SPLINE*",
            "FL*", "GUST", "MKAERO*", "MONPNT*", "TRIM*", "CSSCHD", "DIVERG",
        ],
    ),
    entries(LeftOut, "rotors", &["ROTOR*", "RSPIN*", "UNBALNC", "RGYRO", "CBEAR*"]),
    entries(
        Refused,
        "generators of grid points and cells",
        &[
            "GRIDA", "GRIDB", "GRIDG", "GRIDU", "GRIDD", "GRIDMOD", "EGRID", "CGEN", "EQUIV", "SEBULK",
            "BEGIN *",
        ],
    ),
    entries(
        Refused,
        "other solid cells",
        &[
            "CHEX*", "CTET*", "CPEN*", "CPYR*", "CIHEX*", "CIFHEX", "CIFPENT", "CWEDGE*", "CRAC3D", "CHEXCZ",
            "CPENTCZ",
        ],
    ),
];

/// Words in the names of solid cells, also of those that are in no table.
pub(super) const SOLID: [&str; 6] = ["HEX", "TET", "PENT", "PYR", "WEDGE", "BRICK"];

/// Number of fields of a card, blank ones up to the end of a line included, if further fields are not part of it.
pub(super) fn n_fields(name: &str) -> Option<usize> {
    match name {
        "GRID" | "GRDSET" | "CORD1R" | "CORD1C" | "CORD1S" | "SPC" => Some(8),
        "CORD2R" | "CORD2C" | "CORD2S" => Some(16),
        _ => None,
    }
}
