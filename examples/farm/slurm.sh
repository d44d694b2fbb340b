#!/bin/bash
# Renders one image on a Slurm cluster whose nodes share a file system.
#   examples/farm/slurm.sh SCENE IMAGE PARTS [options of sbatch, such as --cpus-per-task=8 --gres=gpu:1]
# An array renders the parts; when all are done, a second job merges and removes them. A job that fails is tried again by
#   scontrol requeue, or by running this script once more, which renders missing parts.
set -eu
scene=$(printf %q "$(realpath "$1")") picture=$(printf %q "$(realpath -m "$2")") parts=$3
place=$(realpath -m "$2").parts
shift 3
folder=$(printf %q "$place")
mkdir -p "$place"
array=$(sbatch --parsable --job-name=glint --array="1-$parts" --output="$place/%a.log" --requeue "$@" <<EOS
#!/bin/bash
part=\$SLURM_ARRAY_TASK_ID
test -e $folder/\$part.part || exec glint render $scene --part "\$part/$parts" -o $folder/\$part.part
EOS
)
sbatch --job-name=glint-merge --dependency="afterok:$array" --output="$place/merge.log" <<EOS
#!/bin/bash
glint merge $folder/{1..$parts}.part -o $picture && rm -r $folder
EOS
