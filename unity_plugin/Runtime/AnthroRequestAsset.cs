using UnityEngine;

namespace Anthronet
{
    /// <summary>A request as a project asset, which any number of characters can share.</summary>
    [CreateAssetMenu(fileName = "Person", menuName = "AnthroNet/Request", order = 300)]
    public sealed class AnthroRequestAsset : ScriptableObject
    {
        [SerializeField] AnthroRequest request = new AnthroRequest();

        /// <summary>The request.</summary>
        public AnthroRequest Request
        {
            get { return request; }
            set { request = value ?? new AnthroRequest(); }
        }
    }
}
