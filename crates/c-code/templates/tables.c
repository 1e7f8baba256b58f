/* The tables: what is constant. They are plain data and belong into flash. */

/* How the path goes on at the end of a piece. */
#define CONTINUES 0u /* a further part of the same polynomial */
{%- if self.has_joint("SMOOTH") %}
#define SMOOTH 1u    /* another polynomial in the same direction, or none */
{%- endif %}
{%- if self.has_joint("BREAKS") %}
#define BREAKS 2u    /* the tangent breaks: what is left of a step goes on behind the corner as a chord of its own */
{%- endif %}

/* A short part of the path: C(t) = origin + 2^e N(t){% if rational %}/W(t){% endif %}, t from 0 to 1, with N(t) = sum(n_k t^k), k = 1 to p{% if rational %}, and
 * W(t) = sum(w_k t^k), k = 0 to p{% endif %}. */
typedef struct {
    int64_t origin[AXES];          /* in 2^-39 mm */
    number least_step_per_chord;   /* the range of sigma, for which the ranges of all numbers are proven */
    number greatest_step_per_chord;
    uint16_t joint_ratio;          /* |C'| at the end over |C'| at the begin of the next piece: this / 2^16 ... */
    int8_t joint_exponent;         /* ... times 2^this */
{%- if !floating %}
    int8_t coordinate_exponent;    /* e: its coefficients are in units of 2^e mm */
    int8_t step_exponent;          /* s: the step over the piece is 2^s */
    int8_t range_exponent;         /* r: its polynomials take x, the step over 2^r */
{%- endif %}
    uint8_t joint;
} piece_row;

static const piece_row pieces[] = {
{%- for row in pieces %}
    { { {{ row.origin }} }, {{ row.range }}, {{ row.joint_ratio }}u, {{ row.joint_exponent }}, {% if !floating %}{{ row.coordinate_exponent }}, {{ row.step_exponent }}, {{ row.range_exponent }}, {% endif %}{{ row.joint }} },
{%- endfor %}
};

/* n_1 to n_p of each piece and coordinate. */
static const number numerators[][AXES][DEGREE] = {
{%- for rows in numerators %}
    { {{ rows }} },
{%- endfor %}
};
{%- if rational %}

/* w_0 to w_p of each piece. */
static const number weights[][DEGREE + 1u] = {
{%- for row in weights %}
    { {{ row }} },
{%- endfor %}
};
{%- endif %}

/* How the feed goes from v to v + change over a stage: along a curve g(x) from (0, 0) to (1, 1). */
{%- for shape in shapes %}
#define {{ shape.name }} {{ shape.index }}u /* g = {{ shape.formula }} */
{%- endfor %}

/* A stage of the plan, with time in 2^-32 periods and distance in the unit of chords. */
typedef struct {
    uint64_t duration;
    uint64_t reciprocal;           /* 2^(64 + reciprocal_exponent) / duration, rounded down: its first bit is set */
    number period_share;           /* one period over the duration */
    number feed;                   /* v, at the begin, a period */
    number change;
{%- if uses.bent %}
    number bend;                   /* b, of the shape that has one */
{%- endif %}
    uint8_t reciprocal_exponent;
    uint8_t shape;
} stage_row;

static const stage_row stages[] = {
{%- for row in stages %}
    { {{ row.duration }}ULL, {{ row.reciprocal }}ULL, {{ row.numbers }}, {{ row.reciprocal_exponent }}u, {{ row.shape }} },
{%- endfor %}
};

/* For each stage the period in which it ends, in a run at the plan's own speed: when it begins, where it leads, and its distance. All
 * are known when the plan is compiled. */
typedef struct {
    uint32_t rest;                 /* what is left of the stage where the period begins, less one unit of 2^-32 periods */
    uint32_t time;                 /* time of the stage in which the period ends, at its end, in 2^-32 periods */
    uint32_t stages;               /* rows from this stage to that one; 0: no such period begins here */
    number distance;               /* of the period */
} crossing_row;

static const crossing_row crossings[] = {
{%- for row in crossings %}
    { {{ row.rest }}u, {{ row.time }}u, {{ row.stages }}u, {{ row.distance }} },
{%- endfor %}
};

/* The numbers of the first piece and stage of a section, and of those behind its last. */
typedef struct {
    uint32_t first_piece;
    uint32_t end_piece;
    uint32_t first_stage;
    uint32_t end_stage;
} section_row;

static const section_row sections[] = {
{%- for row in sections %}
    { {{ row.pieces.start }}u, {{ row.pieces.end }}u, {{ row.stages.start }}u, {{ row.stages.end }}u },
{%- endfor %}
};

/* The number behind the last piece, and the last stage, of the present section. */
IN_PLACE uint32_t end_piece(const {{ name }}_state *state)
{
{%- if sections.len() == 1 %}
    (void)state;
    return {{ sections[0].pieces.end }}u;
{%- else %}
    return sections[state->section].end_piece;
{%- endif %}
}

IN_PLACE uint32_t end_stage(const {{ name }}_state *state)
{
{%- if sections.len() == 1 %}
    (void)state;
    return {{ sections[0].stages.end }}u;
{%- else %}
    return sections[state->section].end_stage;
{%- endif %}
}

/* One correction is enough after |f| <= RESIDUAL with |g| <= GROWTH, and after |f| <= FLUCTUATION; a period evaluates the chord
 * MAX_EVALUATIONS times at most, and then a few times for each further piece. */
#define RESIDUAL {{ residual }}
#define GROWTH {{ growth }}
#define FLUCTUATION {{ fluctuation }}
#define MAX_EVALUATIONS {{ max_evaluations }}u
{%- if has_joints %}
/* So many may a further piece take, whatever was used before. */
#define BEHIND_JOINT {{ behind_joint }}u
{%- endif %}

/* A T^2, in the unit of chords: from so long a step the axes come to rest within a period. */
#define LANDING_STEP {{ landing_step }}

/* 1/2, 3/8, 3/4{% if uses.third %}, 1/3{% endif %} in the format. */
#define ONE_HALF {{ one_half }}
#define THREE_EIGHTHS {{ three_eighths }}
#define THREE_QUARTERS {{ three_quarters }}
{%- if uses.third %}
#define ONE_THIRD {{ one_third }}
{%- endif %}
