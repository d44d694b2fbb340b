#!/bin/bash
# Renders one image on a Slurm cluster whose nodes share a file system.
#   examples/farm/slurm.sh SCENE IMAGE PARTS [options of sbatch, such as --cpus-per-task=8 --gres=gpu:1]
# An array renders the parts; when all are done, a second job merges them. A job that fails is tried again by
#   scontrol requeue, or by running this script once more, which renders missing parts.
set -eu
scene=$(realpath "$1") picture=$(realpath -m "$2") parts=$3
shift 3
folder=$picture.parts
mkdir -p "$folder"
array=$(sbatch --parsable --job-name=glint --array="1-$parts" --output="$folder/%a.log" --requeue "$@" <<EOS
#!/bin/bash
part=\$SLURM_ARRAY_TASK_ID
test -e "$folder/\$part.part" || exec glint render "$scene" --part "\$part/$parts" -o "$folder/\$part.part"
EOS
)
sbatch --job-name=glint-merge --dependency="afterok:$array" --output="$folder/merge.log" <<EOS
#!/bin/bash
exec glint merge "$folder"/*.part -o "$picture"
EOS
