/* The calls of MPI that a team needs. Every function returns 0, the error code of MPI, or one of these. */

enum { HAS_ENDED = -1, NO_THREADS = -2 };

#include <mpi.h>
#include <stdlib.h>

/* Starts MPI, unless the program has; afterwards only the calling thread may call it. */
int emmy_mpi_start(int *rank, int *size, int *is_ours)
{
    int is_started, has_ended, provided, code;
    if ((code = MPI_Finalized(&has_ended)) || (code = MPI_Initialized(&is_started)))
        return code;
    if (has_ended)
        return HAS_ENDED;
    *is_ours = !is_started;
    if (!is_started && (code = MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided)))
        return code;
    if (is_started && (code = MPI_Query_thread(&provided)))
        return code;
    if (provided < MPI_THREAD_FUNNELED)
        return NO_THREADS;
    if ((code = MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN)))
        return code;
    if ((code = MPI_Comm_rank(MPI_COMM_WORLD, rank)))
        return code;
    return MPI_Comm_size(MPI_COMM_WORLD, size);
}

/* This rank's group of `size` consecutive ranks, and the first ranks of all groups. */
static MPI_Comm group = MPI_COMM_NULL, leaders = MPI_COMM_NULL;

int emmy_mpi_group(int rank, int size)
{
    int code;
    if ((code = MPI_Comm_split(MPI_COMM_WORLD, rank / size, rank, &group)))
        return code;
    return MPI_Comm_split(MPI_COMM_WORLD, rank % size ? MPI_UNDEFINED : 0, rank, &leaders);
}

int emmy_mpi_end(void)
{
    int code;
    if (leaders != MPI_COMM_NULL && (code = MPI_Comm_free(&leaders)))
        return code;
    if (group != MPI_COMM_NULL && (code = MPI_Comm_free(&group)))
        return code;
    return MPI_Finalize();
}

/* Gathers n numbers of every rank, in the order of the ranks; all: [size][n]. */
int emmy_mpi_gather(const double *own, int n, double *all)
{
    return MPI_Allgather(own, n, MPI_DOUBLE, all, n, MPI_DOUBLE, MPI_COMM_WORLD);
}

/* The same on the first rank of each group, for the ranks of the group. */
int emmy_mpi_gather_group(const double *own, int n, double *all)
{
    return MPI_Gather(own, n, MPI_DOUBLE, all, n, MPI_DOUBLE, 0, group);
}

/* The same on the first ranks of all groups, for these ranks. */
int emmy_mpi_gather_leaders(const double *own, int n, double *all)
{
    return MPI_Allgather(own, n, MPI_DOUBLE, all, n, MPI_DOUBLE, leaders);
}

/* Gives the numbers of the first rank of each group to the others of the group. */
int emmy_mpi_tell_group(double *numbers, int n)
{
    return MPI_Bcast(numbers, n, MPI_DOUBLE, 0, group);
}

/* Sends n_out[i] numbers to ranks[i] and receives n_in[i] numbers from it, for i < n. */
int emmy_mpi_exchange(int n, const int *ranks, const double *const *out, const int *n_out, double *const *in, const int *n_in)
{
    int i, code = MPI_SUCCESS;
    MPI_Request *requests = malloc(2 * (size_t)n * sizeof *requests);
    if (n > 0 && !requests)
        return MPI_ERR_NO_MEM;
    for (i = 0; i < 2 * n; i++)
        requests[i] = MPI_REQUEST_NULL;
    for (i = 0; i < n && !code; i++)
        code = MPI_Irecv(in[i], n_in[i], MPI_DOUBLE, ranks[i], 0, MPI_COMM_WORLD, &requests[i]);
    for (i = 0; i < n && !code; i++)
        code = MPI_Isend(out[i], n_out[i], MPI_DOUBLE, ranks[i], 0, MPI_COMM_WORLD, &requests[n + i]);
    if (!code)
        code = MPI_Waitall(2 * n, requests, MPI_STATUSES_IGNORE);
    free(requests);
    return code;
}

/* Text of an error code; text: at least 512 bytes (MPI_MAX_ERROR_STRING is 256 in Open MPI, 512 in MPICH). */
int emmy_mpi_text(int code, char *text, int *length)
{
    return MPI_Error_string(code, text, length);
}

/* Ends all ranks. */
void emmy_mpi_abort(int code)
{
    MPI_Abort(MPI_COMM_WORLD, code);
}
