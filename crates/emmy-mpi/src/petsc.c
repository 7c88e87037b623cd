/* Engines of PETSc: a matrix of all ranks in 3 x 3 blocks with a factorisation by MUMPS or a cycle of GAMG. Functions return
   0, an error code of PETSc, or FAILED for a matrix without a factorisation, which all ranks return together. */

#include <petscksp.h>
#include <petscpc.h>
#include <stdio.h>
#include <string.h>

#if defined(PETSC_USE_COMPLEX) || !defined(PETSC_USE_REAL_DOUBLE)
#error "emmy-mpi needs a PETSc of real numbers in double precision"
#endif

enum { FAILED = -1 };

/* Message of the last error. */
static char message[1024];

typedef struct {
    Mat matrix;
    PC inverse;
    Vec right, solution;
} Engine;

static PetscErrorCode note(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                           PetscErrorType type, const char *text, void *context)
{
    (void)comm, (void)line, (void)file, (void)context;
    if (type == PETSC_ERROR_INITIAL)
        snprintf(message, sizeof message, "%s (in %s)", text ? text : "an error of PETSc", function ? function : "PETSc");
    return code;
}

const char *emmy_petsc_message(void)
{
    return message;
}

/* Sets an option unless PETSC_OPTIONS has it. */
static PetscErrorCode set_default(const char *name, const char *value)
{
    PetscBool is_set;
    PetscFunctionBeginUser;
    PetscCall(PetscOptionsHasName(NULL, NULL, name, &is_set));
    if (!is_set)
        PetscCall(PetscOptionsSetValue(NULL, name, value));
    PetscFunctionReturn(0);
}

/* Starts PETSc on all ranks, unless it is running. Options come from PETSC_OPTIONS alone, signals stay with the program. */
int emmy_petsc_start(void)
{
    PetscBool is_running;
    PetscErrorCode code;
    if ((code = PetscInitialized(&is_running)) || is_running)
        return code;
    if ((code = PetscOptionsSetValue(NULL, "-no_signal_handler", "true")) ||
        (code = PetscOptionsSetValue(NULL, "-skip_petscrc", "true")) ||
        (code = PetscOptionsSetValue(NULL, "-options_left", "false")) || (code = PetscInitializeNoArguments()))
        return code;
    PetscFunctionBeginUser;
    PetscCall(PetscPushErrorHandler(note, NULL));
    PetscCall(set_default("-emmy_direct_mat_mumps_icntl_14", "50")); /* per cent of memory for pivots */
    PetscCall(set_default("-emmy_multigrid_mg_levels_ksp_type", "chebyshev"));
    PetscCall(set_default("-emmy_multigrid_mg_levels_ksp_max_it", "2"));
    PetscCall(set_default("-emmy_multigrid_mg_levels_pc_type", "jacobi"));
    PetscFunctionReturn(0);
}

/* Ends PETSc, if it is running. */
int emmy_petsc_end(void)
{
    PetscBool is_running, has_ended;
    PetscErrorCode code;
    if ((code = PetscInitialized(&is_running)) || (code = PetscFinalized(&has_ended)))
        return code;
    return is_running && !has_ended ? PetscFinalize() : 0;
}

/* Whether all numbers of matrices with n entries on a rank and so many rows in all fit this PETSc. */
int emmy_petsc_fits(size_t n_rows, size_t n_entries)
{
    return n_rows <= PETSC_MAX_INT && n_entries <= PETSC_MAX_INT;
}

static PetscErrorCode create_matrix(Engine *engine, PetscInt n_own, PetscInt first, const size_t *begin, const size_t *columns)
{
    PetscInt row, *diagonal, *other;
    size_t at;
    PetscFunctionBeginUser;
    PetscCall(PetscCalloc2(n_own, &diagonal, n_own, &other));
    for (row = 0; row < n_own; row++)
        for (at = begin[row]; at < begin[row + 1]; at++)
            if (columns[at] >= (size_t)first && columns[at] < (size_t)(first + n_own))
                diagonal[row]++;
            else
                other[row]++;
    PetscCall(MatCreate(PETSC_COMM_WORLD, &engine->matrix));
    PetscCall(MatSetSizes(engine->matrix, 3 * n_own, 3 * n_own, PETSC_DETERMINE, PETSC_DETERMINE));
    PetscCall(MatSetBlockSize(engine->matrix, 3));
    PetscCall(MatSetType(engine->matrix, MATAIJ));
    PetscCall(MatXAIJSetPreallocation(engine->matrix, 3, diagonal, other, NULL, NULL));
    PetscCall(PetscFree2(diagonal, other));
    PetscCall(MatSetOption(engine->matrix, MAT_SYMMETRIC, PETSC_TRUE));
    PetscCall(MatSetOption(engine->matrix, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
    PetscCall(MatCreateVecs(engine->matrix, &engine->solution, &engine->right));
    PetscFunctionReturn(0);
}

static PetscErrorCode create_inverse(Engine *engine, int is_multigrid)
{
    PetscReal threshold = 0.01;
    PetscFunctionBeginUser;
    PetscCall(PCCreate(PETSC_COMM_WORLD, &engine->inverse));
    if (is_multigrid) {
        /* The eigenvalues of smoothers are estimated by conjugate gradients. */
        PetscCall(MatSetOption(engine->matrix, MAT_SPD, PETSC_TRUE));
        PetscCall(PCSetOptionsPrefix(engine->inverse, "emmy_multigrid_"));
        PetscCall(PCSetType(engine->inverse, PCGAMG));
        PetscCall(PCGAMGSetType(engine->inverse, PCGAMGAGG));
        PetscCall(PCGAMGSetThreshold(engine->inverse, &threshold, 1));
    } else {
        PetscCall(PCSetOptionsPrefix(engine->inverse, "emmy_direct_"));
        PetscCall(PCSetType(engine->inverse, PCCHOLESKY));
        PetscCall(PCFactorSetMatSolverType(engine->inverse, MATSOLVERMUMPS));
    }
    PetscCall(PCSetFromOptions(engine->inverse));
    PetscCall(PCSetOperators(engine->inverse, engine->matrix, engine->matrix));
    PetscFunctionReturn(0);
}

/* The rigid modes at the positions, [row][3], as the near-null space. */
static PetscErrorCode set_rigid_modes(Engine *engine, const double *positions)
{
    Vec points;
    PetscScalar *numbers;
    PetscInt n;
    MatNullSpace modes;
    PetscFunctionBeginUser;
    PetscCall(VecDuplicate(engine->right, &points));
    PetscCall(VecSetBlockSize(points, 3));
    PetscCall(VecGetLocalSize(points, &n));
    PetscCall(VecGetArrayWrite(points, &numbers));
    memcpy(numbers, positions, (size_t)n * sizeof *positions);
    PetscCall(VecRestoreArrayWrite(points, &numbers));
    PetscCall(MatNullSpaceCreateRigidBody(points, &modes));
    PetscCall(MatSetNearNullSpace(engine->matrix, modes));
    PetscCall(MatNullSpaceDestroy(&modes));
    PetscCall(VecDestroy(&points));
    PetscFunctionReturn(0);
}

/* Sets the matrix of an engine, which is created if there is none: own rows from `first` on, couplings begin[i] to begin[i + 1]
   of each with their columns and blocks [3][3] by rows. */
int emmy_petsc_set(Engine **own, int is_multigrid, size_t n_own, size_t first, const size_t *begin, const size_t *columns,
                   const double *blocks, const double *positions)
{
    Engine *engine;
    PCFailedReason reason;
    PetscInt row, column;
    size_t i, at;
    int failed;
    PetscFunctionBeginUser;
    if (!*own) {
        PetscCall(PetscNew(own));
        PetscCall(create_matrix(*own, (PetscInt)n_own, (PetscInt)first, begin, columns));
    }
    engine = *own;
    for (i = 0; i < n_own; i++)
        for (at = begin[i]; at < begin[i + 1]; at++) {
            row = (PetscInt)(first + i), column = (PetscInt)columns[at];
            PetscCall(MatSetValuesBlocked(engine->matrix, 1, &row, 1, &column, blocks + 9 * at, INSERT_VALUES));
        }
    PetscCall(MatAssemblyBegin(engine->matrix, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(engine->matrix, MAT_FINAL_ASSEMBLY));
    if (is_multigrid)
        PetscCall(set_rigid_modes(engine, positions));
    if (!engine->inverse || is_multigrid) {
        /* GAMG keeps the near-null space of its first matrix, even after PCReset. */
        PetscCall(PCDestroy(&engine->inverse));
        PetscCall(create_inverse(engine, is_multigrid));
    }
    PetscCall(PCSetUp(engine->inverse));
    PetscCall(PCGetFailedReason(engine->inverse, &reason));
    failed = reason != PC_NOERROR;
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD));
    if (failed) {
        /* The next matrix begins without the failure. */
        PetscCall(PCDestroy(&engine->inverse));
        snprintf(message, sizeof message, "the factorisation failed (%s)",
                 reason == PC_FACTOR_OUTMEMORY ? "not enough memory" : "a pivot is zero, or another reason");
        PetscFunctionReturn(FAILED);
    }
    PetscFunctionReturn(0);
}

/* Replaces the own numbers of a right-hand side, n of them, by those of its solution. */
int emmy_petsc_apply(Engine *engine, size_t n, double *x)
{
    PetscScalar *right;
    const PetscScalar *solution;
    PetscFunctionBeginUser;
    PetscCall(VecGetArrayWrite(engine->right, &right));
    memcpy(right, x, n * sizeof *x);
    PetscCall(VecRestoreArrayWrite(engine->right, &right));
    PetscCall(PCApply(engine->inverse, engine->right, engine->solution));
    PetscCall(VecGetArrayRead(engine->solution, &solution));
    memcpy(x, solution, n * sizeof *x);
    PetscCall(VecRestoreArrayRead(engine->solution, &solution));
    PetscFunctionReturn(0);
}

/* Frees an engine, unless PETSc has ended. */
int emmy_petsc_free(Engine *engine)
{
    PetscBool has_ended;
    PetscErrorCode code;
    if ((code = PetscFinalized(&has_ended)) || has_ended)
        return code;
    PetscFunctionBeginUser;
    PetscCall(PCDestroy(&engine->inverse));
    PetscCall(VecDestroy(&engine->right));
    PetscCall(VecDestroy(&engine->solution));
    PetscCall(MatDestroy(&engine->matrix));
    PetscCall(PetscFree(engine));
    PetscFunctionReturn(0);
}
